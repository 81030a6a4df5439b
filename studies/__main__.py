"""`python -m studies`: the main job on the letter's scene; `--all`: every study; and the page of results."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

from studies.programs import names, unknown


def main() -> int:
    """Run the transitions and write the page, or run every study."""
    arguments = sys.argv[1:]
    if arguments and not arguments[0].startswith("-"):
        name = arguments[0].removeprefix("studies.")
        words = f"a study runs as python -m studies.{name}" if name in names() else unknown(name)
        print(f"python -m studies: {words}", file=sys.stderr)
        return 2
    if "--all" in arguments and "--dump-scene" not in arguments:
        from studies import every_study

        return every_study.main(arguments)
    from studies.page import told_page
    from studies.transitions.__main__ import transitions

    arguments = [word for word in arguments if word != "--all"]
    code = transitions.main(arguments, module="studies")
    if code in (0, 3) and not {"--help", "-h", "--dump-scene"}.intersection(arguments):
        out = next((b for a, b in pairwise(arguments) if a == "--out"), "results")
        out = next((word.partition("=")[2] for word in arguments if word.startswith("--out=")), out)
        print(told_page(Path(out)), file=sys.stderr)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
