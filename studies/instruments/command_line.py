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
nothing else.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import shlex
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, TextIO

from studies import single_blas_thread
from studies.instruments.adequacy.fitted_scene import Need, fitted
from studies.instruments.progress import Progress, duration
from studies.instruments.record import SCHEMA, Record, json_text
from studies.instruments.scene import Scene
from studies.instruments.scene_file import dump_scene, read_scene

DONE, WRONG_USE, FAILED_CELLS, INTERRUPTED = 0, 2, 3, 130
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
Options = Callable[[argparse.ArgumentParser], None]


class WrongUse(ValueError):
    """The arguments make no sense; the message is one sentence."""


class _Parser(argparse.ArgumentParser):
    output: TextIO | None = None

    def print_help(self, file: Any = None) -> None:
        super().print_help(self.output if file is None else file)

    def error(self, message: str) -> NoReturn:
        raise WrongUse(f"{message} (--help lists the options)")


def _positive(text: str) -> int:
    try:
        number = int(text)
    except ValueError:
        number = 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be a whole number of at least 1, not {text!r}")
    return number


def _parser(command: str, description: str, options: Options | None) -> _Parser:
    parser = _Parser(prog=command, description=description, allow_abbrev=False)
    parser.add_argument("--scene", default="letter", metavar="FILE.toml",
                        help="scene: a file, or the name of one in studies/scenes (default: letter)")
    parser.add_argument("--set", action="append", default=[], metavar="section.key=value", dest="overrides",
                        help="change one key of the scene; may be repeated")
    parser.add_argument("--quick", action="store_true", help="a small form of the study, for a first look")
    parser.add_argument("--out", default="results", metavar="DIR",
                        help="folder in which the study makes its own (default: results)")
    parser.add_argument("--json", action="store_true", help="print the summary as one JSON object")
    parser.add_argument("--workers", type=_positive, default=os.cpu_count() or 1, metavar="N",
                        help="threads or processes (default: one for each core)")
    parser.add_argument("--executor", default="", metavar="URL",
                        help="where a sweep runs: threads, processes or dask://host:port")
    parser.add_argument("--dump-scene", action="store_true",
                        help="print every key of the scene with unit, default and provenance, and stop")
    if options is not None:
        options(parser)
    return parser


@contextlib.contextmanager
def _standard_output_kept_clean() -> Iterator[TextIO]:
    """Yield standard output; whatever else is printed meanwhile, even by a worker, goes to standard error."""
    wanted = sys.stdout
    kept: int | None = None
    with contextlib.suppress(AttributeError, OSError, ValueError, io.UnsupportedOperation):
        wanted.flush()
        if wanted.fileno() == 1 and sys.stderr.fileno() == 2:
            kept = os.dup(1)
            os.dup2(2, 1)
    try:
        if kept is None:
            with contextlib.redirect_stdout(sys.stderr):
                yield wanted
        else:
            with contextlib.redirect_stdout(sys.stderr), open(os.dup(kept), "w", encoding="utf-8") as output:
                yield output
    finally:
        if kept is not None:
            os.dup2(kept, 1)
            os.close(kept)


def _say(words: str) -> None:
    print(words, file=sys.stderr, flush=True)


def _one_sentence(error: BaseException) -> str:
    return " ".join(str(error).split()) or f"{type(error).__name__} without a message"


def _computed(run: Run, scene: Scene, request: Request) -> tuple[int, str, Mapping[str, Any]]:
    """Exit code, status and results of the run."""
    from contact.errors import ContactError

    try:
        results = run(scene, request)
    except KeyboardInterrupt:
        return INTERRUPTED, "interrupted", {}
    except ContactError as error:
        return FAILED_CELLS, "failed", {"failure": f"{type(error).__name__}: {_one_sentence(error)}"}
    if results.get("failed_cells", 0):
        return FAILED_CELLS, "finished with failed cells", results
    return DONE, "done", results


def _study(
    name: str,
    command: str,
    description: str,
    run: Run,
    argv: Sequence[str],
    options: Options | None,
    needs: Sequence[Need],
    output: TextIO,
) -> int:
    parser = _parser(command, description, options)
    parser.output = output
    arguments = parser.parse_args(argv)
    scene = read_scene(arguments.scene, arguments.overrides)
    if arguments.dump_scene:
        values = {"schema": SCHEMA, "study": name, "scene": scene.as_dict(), "provenance": scene.provenance()}
        print(json_text(values) if arguments.json else dump_scene(scene).rstrip(), file=output)
        return DONE
    model = ""
    if needs and scene.drive.kind == "harmonic":
        scene, model = fitted(scene, needs, _say)
    record = Record(
        study=name,
        folder=Path(arguments.out) / name,
        scene=scene,
        command=shlex.join([*command.split(), *argv]),
        settings={"quick": arguments.quick, "workers": arguments.workers, "executor": arguments.executor},
    )
    request = Request(
        quick=arguments.quick,
        workers=arguments.workers,
        executor=arguments.executor,
        options=arguments,
        record=record,
    )
    code, status, results = _computed(run, scene, request)
    summary = record.close(status, {**results, "model_choice": model} if model else results)
    if model and code in (DONE, FAILED_CELLS):
        _say(model)
    took = duration(record.wall_time)
    if code == INTERRUPTED:
        _say(f"{command}: interrupted after {took}; what was stored is in {record.folder}; go on with: "
             f"{record.command}")
    else:
        _say(f"{command}: {status} in {took}; {len(record.files)} files in {record.folder}"
             + (f"; {results['failure']}" if "failure" in results else ""))
    if arguments.json:
        print(json_text({**summary, "exit_code": code}), file=output)
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
    with _standard_output_kept_clean() as output:
        try:
            try:
                return _study(name, command, description, run, arguments, options, needs, output)
            except SystemExit as leaving:  # --help
                return DONE if leaving.code in (None, 0) else WRONG_USE
            except KeyboardInterrupt:
                _say(f"{command}: interrupted; nothing was stored; go on with: "
                     f"{shlex.join([*command.split(), *arguments])}")
                return INTERRUPTED
            except (ValueError, TypeError, OSError) as error:
                if os.environ.get(TRACEBACK) == "1":
                    traceback.print_exc()
                sentence = _one_sentence(error)
                _say(f"{command}: {sentence}")
                if "--json" in arguments:
                    refusal = {"schema": SCHEMA, "study": name, "status": "refused", "error": sentence}
                    print(json_text({**refusal, "exit_code": WRONG_USE}), file=output)
                return WRONG_USE
        finally:
            with contextlib.suppress(BrokenPipeError):
                output.flush()
