"""Studies: one program per question, on top of `beam` (the spring) and `contact` (the impacts).

    python -m studies             the main job: the letter's transitions, and the page of results
    python -m studies NAME        any study, or `report`, `tour`, `explore`, `pictures`
    python -m studies --list      the chapters, one line a study
    python -m studies --all       every study

The chapters are `experiment`, `spring`, `methods` and `measurement`.  They share `physics` and `shell`; a
chapter never imports another one.  `letter` has the numbers and the points of the letter.

A *scene* holds the physical values: studies/scenes/letter.toml, or one's own (--scene FILE, --set
section.key=value).  Each value has a unit and an origin: the letter, calibrated or assumed.  A study takes
the spring from the scene, with as many modes as its question needs.  In results/NAME/ it stores tables (csv),
arrays (npz) and figures (png, pdf) drawn from them.  summary.json has the results in numbers, and
manifest.json has versions, parameters and the command.

Importing this package from Python changes nothing.  As a program it first prepares its process:

- It sets the thread count of the linear algebra libraries to 1, unless the environment sets it.  Several
  workers with several threads each slow one another down twentyfold.
- It makes sure that `beam` and `contact` are the packages beside this one.  The public index has other
  packages of both names, with which the studies would fail or compute something else.
- It ends with one sentence at Ctrl-C during the imports.
"""

from __future__ import annotations

import importlib.util
import os
import signal
import sys
from itertools import pairwise
from pathlib import Path

__version__ = "0.9.0"

ROOT = Path(__file__).resolve().parent.parent
"""The folder in which `beam`, `contact` and `studies` lie side by side."""


def refuse_foreign_packages(root: Path = ROOT) -> None:
    """ImportError unless `beam` and `contact` would be imported from the folder `root`."""
    for name in ("beam", "contact"):
        spec = importlib.util.find_spec(name)
        places = [] if spec is None else list(spec.submodule_search_locations or [])
        if not places:
            raise ImportError(
                f"the package '{name}' of grazing-spring is missing beside 'studies': run "
                "`python -m studies` from the root of a complete checkout"
            )
        if Path(places[0]).resolve() != root / name:
            raise ImportError(
                f"the package '{name}' in {Path(places[0]).parent} is not that of grazing-spring but another "
                "of the same name: run `python -m studies` from the root of the checkout, or remove the "
                f"other package with `python -m pip uninstall {name}`"
            )


def start_as_program() -> None:
    """Prepare this process for a program: threads, check of the packages, Ctrl-C during the imports."""
    global program
    program = True
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")  # here and in the processes started from here
    if sys.stderr is None:  # started with 2>&-: no file of results may get its number
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:

        def interrupted(number: int, frame: object) -> None:
            print("interrupted; nothing was stored: the same command begins again", file=sys.stderr)
            os._exit(130)

        signal.signal(signal.SIGINT, interrupted)
    refuse_foreign_packages()


program = False
"""Whether this process runs a study as a program, and not as part of another one."""

if sys.argv[:1] == ["-m"]:  # as long as the interpreter looks for the module to run
    start_as_program()
    if any(a == "-m" and b.startswith("studies.") for a, b in pairwise(sys.orig_argv)):  # it would do nothing
        print("a study runs as python -m studies NAME; --list gives the names", file=sys.stderr)
        raise SystemExit(2)
