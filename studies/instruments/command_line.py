"""The command line that all studies share.

    def run(scene: Scene, request: Request) -> Mapping[str, Any]:
        with request.progress("scan", total=81) as progress:
            ...
        request.record.write_arrays("scan", excess=..., tip_displacement=...)
        return {"born_period": 5, "failed_cells": 0}

    def main(argv: Sequence[str] | None = None) -> int:
        return run_study("orbit_diagram", "Orbit diagrams through grazing.", run, argv)

    if __name__ == "__main__":
        raise SystemExit(main())

Exit codes: 0 done; 2 wrong use, told in one sentence; 3 finished with failed cells (`failed_cells` in what
`run` returns, or a failed computation); 130 interrupted, with what was stored kept and the command that goes
on. What is meant for people goes to standard error; with --json standard output carries one JSON object and
nothing else. Suspicious values of the scene (`plausibility`) are told before the run, one line "warning: ..."
each, and kept as `warnings` in the summary.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from beam import SuspiciousValue
from studies import single_blas_thread
from studies.instruments.adequacy.fitted_scene import Need, fitted
from studies.instruments.interruption import INTERRUPTED, Interruption
from studies.instruments.options import Options, WrongUse, parser_of
from studies.instruments.progress import Progress, duration
from studies.instruments.record import SCHEMA, Record, json_text
from studies.instruments.scene import Scene
from studies.instruments.scene_file import dump_scene, read_scene
from studies.instruments.standard_output import kept_clean, tell

__all__ = ["DONE", "FAILED_CELLS", "INTERRUPTED", "WRONG_USE", "Request", "WrongUse", "run_study"]

DONE, WRONG_USE, FAILED_CELLS = 0, 2, 3
TRACEBACK = "GRAZING_SPRING_TRACEBACK"
"""Set to 1 in the environment, it shows where a refused input was noticed."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """What the command line asks of a study besides its scene."""

    quick: bool
    workers: int
    executor: str
    options: argparse.Namespace
    record: Record

    def progress(self, label: str, total: int | None = None) -> Progress:
        return Progress(label, total)


Run = Callable[[Scene, Request], Mapping[str, Any]]


@dataclass(frozen=True, kw_only=True)
class _Study:
    """A study as the command line knows it."""

    name: str
    command: str
    description: str
    run: Run
    options: Options | None
    needs: Sequence[Need]


def _say(words: str) -> None:
    tell(words, sys.stderr)


def _one_sentence(error: BaseException) -> str:
    return " ".join(str(error).split()) or f"{type(error).__name__} without a message"


def _read(arguments: argparse.Namespace) -> tuple[Scene, tuple[str, ...]]:
    """The scene, and what is suspicious about it."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", SuspiciousValue)
        scene = read_scene(arguments.scene, arguments.overrides)
    for warning in found:
        if not issubclass(warning.category, SuspiciousValue):
            warnings.warn_explicit(warning.message, warning.category, warning.filename, warning.lineno)
    return scene, tuple(str(w.message) for w in found if issubclass(w.category, SuspiciousValue))


def _computed(run: Run, scene: Scene, request: Request) -> tuple[int, str, Mapping[str, Any]]:
    """Exit code, status and results of the run."""
    from contact.errors import ContactError

    try:
        with warnings.catch_warnings():  # a study varies the scene on purpose; what the user gave is told
            warnings.simplefilter("ignore", SuspiciousValue)
            results = run(scene, request)
    except KeyboardInterrupt:
        return INTERRUPTED, "interrupted", {}
    except ContactError as error:
        return FAILED_CELLS, "failed", {"failure": f"{type(error).__name__}: {_one_sentence(error)}"}
    if results.get("failed_cells", 0):
        return FAILED_CELLS, "finished with failed cells", results
    return DONE, "done", results


def _performed(study: _Study, argv: Sequence[str], output: TextIO) -> int:
    account = getattr(sys.modules.get(study.run.__module__), "__doc__", None) or ""
    parser = parser_of(study.command, study.description, account, study.options)
    parser.output = output
    arguments = parser.read(argv)
    scene, suspicious = _read(arguments)
    if arguments.dump_scene:
        values = {"schema": SCHEMA, "study": study.name, "scene": scene.as_dict(),
                  "provenance": scene.provenance()}  # fmt: skip
        tell(json_text(values) if arguments.json else dump_scene(scene).rstrip(), output)
        return DONE
    model = ""
    if study.needs and scene.drive.kind == "harmonic":
        scene, model = fitted(scene, study.needs, _say)
    for sentence in suspicious:  # of a scene that is not refused
        _say(f"warning: {sentence}")
    record = Record(
        study=study.name,
        folder=Path(arguments.out) / study.name,
        scene=scene,
        command=shlex.join([*study.command.split(), *argv]),
        settings={"quick": arguments.quick, "workers": arguments.workers, "executor": arguments.executor},
        warnings=suspicious,
    )
    request = Request(
        quick=arguments.quick,
        workers=arguments.workers,
        executor=arguments.executor,
        options=arguments,
        record=record,
    )

    def close(code: int, status: str, results: Mapping[str, Any]) -> None:
        summary = record.close(status, {**results, "model_choice": model} if model else results)
        if model and code in (DONE, FAILED_CELLS):
            _say(model)
        took = duration(record.wall_time)
        if code == INTERRUPTED:
            _say(f"{study.command}: interrupted after {took}; what was stored is in {record.folder}; go on "
                 f"with: {record.command}")
        else:
            _say(f"{study.command}: {status} in {took}; {len(record.files)} files in {record.folder}"
                 + (f"; {results['failure']}" if "failure" in results else ""))
        if arguments.json:
            tell(json_text({**summary, "exit_code": code}), output)

    with Interruption(lambda: close(INTERRUPTED, "interrupted", {})) as interruption:
        code, status, results = _computed(study.run, scene, request)
        with interruption.calm():
            close(code, status, results)
        if code == INTERRUPTED:
            interruption.end_program(code)
    return code


def run_study(
    name: str,
    description: str,
    run: Run,
    argv: Sequence[str] | None = None,
    *,
    options: Options | None = None,
    needs: Sequence[Need] = (),
    module: str | None = None,
) -> int:
    """Read the arguments, run the study, store and report; returns the exit code.

    Parameters
    ----------
    name : name of the study and of its folder of results.
    description : one or two sentences for --help.
    run : from scene and request to results in terms of JSON; `failed_cells` among them counts the failures.
    argv : arguments, those of the process by default.
    needs : what the numbers of the study rest on; modes and mesh are chosen for it where the scene leaves
        them open (``adequacy.fitted_scene``).
    options : adds options of the study's own to the parser; they arrive as `request.options`.
    module : what follows `python -m`, studies.NAME by default.
    """
    single_blas_thread()
    arguments = list(sys.argv[1:] if argv is None else argv)
    command = f"python -m {module or f'studies.{name}'}"
    study = _Study(
        name=name, command=command, description=description, run=run, options=options, needs=needs
    )
    with kept_clean() as output:
        try:
            return _performed(study, arguments, output)
        except SystemExit as leaving:  # --help
            return DONE if leaving.code in (None, 0) else WRONG_USE
        except KeyboardInterrupt:
            _say(f"{command}: interrupted; nothing was stored; go on with: "
                 f"{shlex.join([*command.split(), *arguments])}")
            return INTERRUPTED
        except BrokenPipeError:  # nobody reads standard error any more
            return INTERRUPTED
        except (ValueError, TypeError, OSError) as error:
            if os.environ.get(TRACEBACK) == "1":
                traceback.print_exc()
            sentence = _one_sentence(error)
            _say(f"{command}: {sentence}")
            if "--json" in arguments:
                refusal = {"schema": SCHEMA, "study": name, "status": "refused", "error": sentence}
                tell(json_text({**refusal, "exit_code": WRONG_USE}), output)
            return WRONG_USE
