"""`python -m studies`: the main job on the letter's scene, and a list of the other studies."""

from __future__ import annotations

import sys

from studies.instruments.programs import MAIN, first_sentence, names, unknown


def main() -> int:
    """Run the transitions, then say what else there is."""
    arguments = sys.argv[1:]
    if arguments and not arguments[0].startswith("-"):
        name = arguments[0].removeprefix("studies.")
        words = f"a study runs as python -m studies.{name}" if name in names() else unknown(name)
        print(f"python -m studies: {words}", file=sys.stderr)
        return 2
    from studies import transitions

    code = transitions.main(arguments, module="studies")
    quiet = {"--json", "--help", "-h", "--dump-scene"}
    if code == 0 and not quiet.intersection(arguments):
        print("other studies:", file=sys.stderr)
        for name in names():
            if name != MAIN:
                print(f"  python -m studies.{name:<18} {first_sentence(name)}", file=sys.stderr)
    return code


if __name__ == "__main__":
    raise SystemExit(main())
