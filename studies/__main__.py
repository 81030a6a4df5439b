"""`python -m studies`: the main job on the letter's scene, the page of all results, a list of the studies."""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

from studies.programs import MAIN, names, title_of, unknown


def main() -> int:
    """Run the transitions, write the page, then say what else there is."""
    arguments = sys.argv[1:]
    if arguments and not arguments[0].startswith("-"):
        name = arguments[0].removeprefix("studies.")
        words = f"a study runs as python -m studies.{name}" if name in names() else unknown(name)
        print(f"python -m studies: {words}", file=sys.stderr)
        return 2
    from studies.page import told_page
    from studies.transitions.__main__ import transitions

    code = transitions.main(arguments, module="studies")
    if code in (0, 3) and not {"--help", "-h", "--dump-scene"}.intersection(arguments):
        out = next((b for a, b in pairwise(arguments) if a == "--out"), "results")
        out = next((word.partition("=")[2] for word in arguments if word.startswith("--out=")), out)
        print(told_page(Path(out)), file=sys.stderr)
        if "--json" not in arguments:
            print("other studies:", file=sys.stderr)
            for name in names():
                if name != MAIN:
                    print(f"  python -m studies.{name:<18} {title_of(name)}", file=sys.stderr)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
