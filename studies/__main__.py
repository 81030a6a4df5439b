"""`python -m studies [NAME]`: run a study; without a name the main job; `--list`, `--all`."""

from __future__ import annotations

import importlib
import runpy
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from studies import __version__, start_as_program
from studies.shell import programs
from studies.shell.programs import COMMAND, DONE, MAIN, chapters_in_words, module_of, names, print_answer


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what the arguments name, by default `sys.argv`; returns the exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given == ["--version"]:
        print_answer(f"grazing-spring {__version__}", sys.stdout)
        return DONE
    if given in (["--list"], ["list"]):
        print_answer(chapters_in_words(), sys.stdout)
        return DONE
    if given and not given[0].startswith("-"):
        return run_program(given[0], given[1:])
    if "--all" not in given and {"--help", "-h"}.intersection(given):
        print_answer(programs.overview(), sys.stdout)
        return DONE
    if "--all" in given and "--dump-scene" not in given:
        from studies.shell import every_study

        return every_study.main(given)
    return main_job([word for word in given if word != "--all"])


def run_program(name: str, arguments: Sequence[str]) -> int:
    """Run the program of this name; an unknown one is answered with the chapters."""
    if name not in names():
        print(f"{COMMAND}: {programs.unknown(name)}\n{chapters_in_words()}", file=sys.stderr)
        return programs.WRONG_USE
    if name == "tour":
        programs.refuse_arguments(name, arguments)
        sys.argv[1:] = []
        runpy.run_module("studies.tour", run_name="__main__")
        return 0
    module = importlib.import_module(module_of(name))
    program = getattr(module, name) if name in programs.studies() else module
    return int(program.main(arguments))


def main_job(arguments: Sequence[str]) -> int:
    """The main study, and then the page of all that is stored."""
    from studies.shell.page import page_sentence

    main_study = getattr(importlib.import_module(module_of(MAIN)), MAIN)
    code = int(main_study.main(arguments, command=COMMAND))
    if code in (0, 3) and "--dump-scene" not in arguments:
        out = next((b for a, b in pairwise(arguments) if a == "--out"), "results")
        out = next((word.partition("=")[2] for word in arguments if word.startswith("--out=")), out)
        print(page_sentence(Path(out)), file=sys.stderr)
    return code


def console() -> int:
    """The command ``grazing-spring``, which is the same."""
    start_as_program()
    return main()


if __name__ == "__main__":
    raise SystemExit(main())
