"""Studies: one program per claim, on top of `beam` (the spring) and `contact` (the impacts).

Run them from the root of the project as `python -m studies.NAME`; `python -m studies` runs the main one and
lists the others, `studies.tour` is the whole package in one script.

What they have in common
    A *scene* (studies/scenes/letter.toml, or one's own: --scene FILE, --set section.key=value) holds the
    physics, each value with its unit and whether it is the letter's, calibrated or assumed. A study takes
    from it the spring, with as many modes as its question needs, computes, stores, and draws from what it
    stored: results/NAME/ has tables (csv), arrays (npz), figures (png, pdf), what was found (summary.json)
    and what it rests on (manifest.json). `studies.report` gathers all of it into one page.

What they show
    The letter's figures: `transitions` (the main job), `hysteresis` (Fig. 3), `time_trace` (Fig. 4),
    `breakdown` (Fig. 5), `claims` and `chart` (the plane). What it left open: `hysteresis` (why measurement
    and map differ), `effective_impact` (higher modes in tau and delay), `soft_wall` (the square root),
    `attractors`, `sensitivity`. To be seen in motion: `motion`. What all of it rests on: `calibrate`,
    `modes`, `spring_shape`, `adequacy`, `work_precision`, `stability`, `benchmarks`.

What several of them use is in `studies.instruments`; the letter's numbers are in `studies.published`.

Importing this package does two things, both of which have to come before numpy is imported (and when it runs
as a program, `start_as_program`):

- it sets the thread count of the linear algebra libraries to 1 unless the environment already says otherwise:
  the matrices here are small, and several workers with several threads each slow one another down twentyfold;
- it makes sure that `beam` and `contact` are the packages beside this one. Both names belong to other
  people's packages on the public index, and with one of those in front every result would be an error at
  best.
"""

from __future__ import annotations

import importlib.util
import os
import sys
import warnings
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
"""The folder in which `beam`, `contact` and `studies` lie side by side."""

THREAD_VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")


def single_blas_thread() -> None:
    """One thread for linear algebra, here and in the processes started from here."""
    for variable in THREAD_VARIABLES:
        os.environ.setdefault(variable, "1")


def place_of(name: str) -> Path | None:
    """The folder that `import NAME` would read, without importing it; None if there is none."""
    try:
        spec = importlib.util.find_spec(name)
    except ValueError:  # already imported, and by something that left no trace of where from
        return None
    if spec is None:
        return None
    if spec.origin is not None:
        return Path(spec.origin).resolve().parent
    folders = list(spec.submodule_search_locations or ())
    return Path(folders[0]).resolve() if folders else None


def refuse_foreign_packages(names: Iterable[str] = ("beam", "contact"), root: Path = ROOT) -> None:
    """ImportError unless each of `names` would be imported from the folder `root`."""
    for name in names:
        place = place_of(name)
        if place is None:
            raise ImportError(
                f"the package '{name}' of grazing-spring is missing beside 'studies': run "
                "`python -m studies` from the root of a complete checkout"
            )
        if place != root / name:
            raise ImportError(
                f"the package '{name}' in {place.parent} is not that of grazing-spring but another of the "
                "same name: run `python -m studies` from the root of the checkout, or remove the other "
                f"package with `python -m pip uninstall {name}`"
            )


def start_as_program() -> None:
    """For `python -m studies...`: all streams there, Ctrl-C without a traceback, a sentence for an unknown
    study."""
    from studies.instruments.interruption import watch_start
    from studies.instruments.programs import named_by, unknown
    from studies.instruments.standard_output import fill_closed

    fill_closed()
    watch_start()
    name = named_by(sys.orig_argv[1:])
    if name is not None:
        print(f"python -m studies.{name}: {unknown(name)}", file=sys.stderr)
        raise SystemExit(2)


def quiet_worker() -> None:
    """In a worker: what is suspicious about the scene has been told by the process that started it."""
    from beam import SuspiciousValue

    warnings.simplefilter("ignore", SuspiciousValue)


if sys.argv[:1] == ["-m"]:  # as long as the interpreter looks for the module that it was told to run
    start_as_program()
single_blas_thread()
refuse_foreign_packages()
if "--multiprocessing-fork" in sys.orig_argv:  # a spawned worker knows its parent only after its imports
    quiet_worker()
