"""`python -m studies`: the main job on the letter's scene, and a list of the other studies."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

from studies import transitions


def others() -> list[tuple[str, str]]:
    """Name and first sentence of every study beside the main one."""
    found = []
    for source in sorted(Path(__file__).parent.glob("*.py")):
        text = source.read_text(encoding="utf-8")
        if source.stem.startswith("_") or source.stem == "transitions" or "def main(" not in text:
            continue
        sentence = (ast.get_docstring(ast.parse(text)) or "").split("\n\n")[0].replace("\n", " ")
        found.append((source.stem, sentence))
    return found


def main() -> int:
    """Run the transitions, then say what else there is."""
    code = transitions.main(sys.argv[1:], module="studies")
    quiet = {"--json", "--help", "-h", "--dump-scene"}
    if code == 0 and not quiet.intersection(sys.argv[1:]) and others():
        print("other studies:", file=sys.stderr)
        for name, sentence in others():
            print(f"  python -m studies.{name:<18} {sentence}", file=sys.stderr)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
