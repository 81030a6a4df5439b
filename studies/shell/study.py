"""A study as a program: the decorator, its command line, exit codes and interruptions.

    @study(needs={"fold": 0.05}, quick={"points": 21})
    def ends(scene: Scene, run: Run, *, points: Annotated[int, "amplitudes"] = 61) -> Mapping[str, object]:
        ...

`needs` names answers of ``physics.least_model`` and their largest errors.  The fewest modes are kept with
which the scene as given meets all of them.  Keyword-only arguments are the options, and `--help` prints the
docstring of the module.  Exit codes stand in `studies.shell.programs`: 3 for `run.failed` or a ContactError
that escapes. Interrupted by Ctrl-C or SIGTERM (a KeyboardInterrupt in the study) it keeps what was stored and
names the command that goes on. A second signal, or one that comes where nothing can be raised (in a callback
of the compiler), ends it at once.
"""

from __future__ import annotations

import contextlib
import inspect
import os
import shlex
import signal
import sys
import threading
import types
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, TextIO, cast

from beam import SuspiciousValue
from contact import ContactError
from studies.physics.least_model import least_modes
from studies.physics.one_mode import doubts, with_restitution
from studies.shell import programs
from studies.shell.executors import duration
from studies.shell.files import SCHEMA
from studies.shell.options import add_options, parser_of, style_of
from studies.shell.programs import DONE, FAILED_CELLS, INTERRUPTED, as_program, print_answer
from studies.shell.run import Run
from studies.shell.scene import Scene, one_stop, read_scene

Function = Callable[..., Mapping[str, object]]
At = Callable[[Scene, Mapping[str, Any]], tuple[Sequence[float], float]]


@dataclass(frozen=True, kw_only=True)
class Study:
    """A study; `main` is its command line, calling it runs its function.

    Parameters
    ----------
    function : function of scene, run and options
    needs : mapping of quantity to tolerance
        What its numbers rest on: where the scene leaves modes.count open it gets the least number of modes
        that gives these quantities (``least_model``).
    quick : mapping of option to value
        Defaults of the small form, --quick.
    at : function of scene and options
        Drive frequencies [Hz] and excess [1] at which its numbers are needed; by default of the scene.
    many_stops : bool
        Whether it takes a scene with [[stops]]; any other study refuses one.
    """

    function: Function
    needs: Mapping[str, float] = field(default_factory=dict)
    quick: Mapping[str, object] = field(default_factory=dict)
    at: At | None = None
    many_stops: bool = False

    def __call__(self, scene: Scene, run: Run, **options: object) -> Mapping[str, object]:
        """Run the function."""
        return self.function(scene, run, **options)

    @property
    def name(self) -> str:
        """The name of the study, of its file and of its folder of results."""
        return self.function.__name__

    def defaults(self, quick: bool) -> dict[str, object]:
        """Its options, where the command line gives none, in the small or the full form."""
        parameters = inspect.signature(self.function).parameters.values()
        own = {one.name: one.default for one in parameters if one.kind is one.KEYWORD_ONLY}
        return {**own, **(self.quick if quick else {})}

    def main(self, argv: Sequence[str] | None = None, *, command: str | None = None) -> int:
        """Read the arguments, run the study, store and report; returns the exit code."""
        arguments = list(sys.argv[1:] if argv is None else argv)
        words = command or f"{programs.COMMAND} {self.name}"
        work = partial(self._perform, words, arguments)
        return programs.perform(self.name, words, arguments, work)

    def _perform(self, command: str, argv: list[str], output: TextIO) -> int:
        account = sys.modules[self.function.__module__].__doc__ or ""
        parser = parser_of(command, f"{account}\n{programs.run_time_of([self.name])}")
        options = add_options(parser, self.function)
        given = vars(parser.read(argv, output))
        scene, doubtful = scene_and_doubts(given["scene"], given["overrides"])
        if given["dump_scene"]:
            answer = {"schema": SCHEMA, "study": self.name, "scene": scene.values()}
            answer |= {"provenance": scene.provenance()}
            print_answer(answer if given["json"] else scene.dump().rstrip(), output)
            return DONE
        if not self.many_stops:
            one_stop(scene)
        chosen = {**self.defaults(given["quick"]), **{name: given[name] for name in options if name in given}}
        chosen = {name: tuple(v) if isinstance(v, list) else v for name, v in chosen.items()}
        for sentence in doubtful:
            print(f"warning: {sentence}", file=sys.stderr)
        how = {name: given[name] for name in ("quick", "workers", "executor", "style")}
        folder, whole = Path(given["out"]) / self.name, shlex.join([*command.split(), *argv])
        run = Run(study=self.name, folder=folder, scene=scene, command=whole, options=chosen, **how)
        run.warnings = doubtful

        def close(code: int, status: str, results: Mapping[str, object]) -> None:
            summary = run.close(status, results)
            took = f"{command}: {status} after {duration(run.wall_time)}"
            if code == INTERRUPTED:
                run.say(f"{took}; what was stored is in {run.folder}; go on with: {run.command}")
            else:
                failed = f"; {len(run.failures)} failed: {run.failures[0]}" if run.failures else ""
                run.say(f"{took}; {len(run.files)} files in {run.folder}{failed}")
            if given["json"]:
                print_answer({**summary, "exit_code": code}, output)

        with _signals(run, lambda: close(INTERRUPTED, "interrupted", {})):
            code, status, results = self._compute(run, chosen)
            close(code, status, results)
        if code == INTERRUPTED and as_program():
            _end(code)
        return code

    def _compute(self, run: Run, options: Mapping[str, object]) -> tuple[int, str, Mapping[str, object]]:
        """Exit code, status and results of the run."""
        try:
            # a study varies the scene on purpose
            with warnings.catch_warnings(action="ignore", category=SuspiciousValue):
                conditions = self.at(run.scene, options) if self.at else ()
                if self.needs:
                    alone = replace(run.scene, stops=())  # modes are chosen with the plate of [stop] alone
                    chosen, why = least_modes(alone, self.needs, *conditions)
                    run.choose_modes(replace(chosen, stops=run.scene.stops), why)
                scene = run.adopt(*with_restitution(run.scene))
                for sentence in doubts(scene):
                    run.warn(sentence)
                with style_of(run.style):
                    results = self.function(scene, run, **options)
        except (KeyboardInterrupt, Exception) as error:
            if _interrupted(error):
                return INTERRUPTED, "interrupted", {}
            if not isinstance(error, ContactError):
                raise
            run.failed(type(error).__name__, error, say=False)  # it stands in the last line
            return FAILED_CELLS, "failed", {}
        if run.failures:
            return FAILED_CELLS, "finished with failed cells", results
        return DONE, "done", results


def study(**about: Any) -> Callable[[Function], Study]:
    """Decorator of the one function of a study; the arguments are the fields of `Study`."""
    return lambda function: Study(function=function, **about)


def scene_and_doubts(name: str, overrides: Sequence[str]) -> tuple[Scene, list[str]]:
    """The scene of a command line, and sentences on what is suspicious in it."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", SuspiciousValue)
        scene = read_scene(name, overrides)
    return scene, list(dict.fromkeys(str(w.message) for w in found if w.category is SuspiciousValue))


def _interrupted(error: BaseException | None) -> bool:
    """Whether this is an interrupt, or what a file said that was being written when one came."""
    return error is not None and (isinstance(error, KeyboardInterrupt) or _interrupted(error.__context__))


@contextlib.contextmanager
def _signals(run: Run, leave: Callable[[], None]) -> Iterator[None]:
    """Ctrl-C and SIGTERM as KeyboardInterrupt, until the run is closed; `leave` stores what there is where a
    program ends at once."""
    signals = dict[int, object]()
    lost = sys.unraisablehook

    def stop() -> None:
        if as_program() and not run.closed:
            with contextlib.suppress(Exception):
                leave()
            _end(INTERRUPTED)

    def signalled(number: int, frame: types.FrameType | None) -> None:
        if run.interrupted:
            stop()
        if not run.closed:
            run.interrupted = True
            raise KeyboardInterrupt

    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) is not signal.SIG_IGN:  # nohup and background jobs of a shell
                signals[number] = signal.signal(number, signalled)
    sys.unraisablehook = lambda fault: (
        stop() if issubclass(fault.exc_type, KeyboardInterrupt) else lost(fault)
    )
    try:
        yield
    finally:
        sys.unraisablehook = lost
        for kept, handler in signals.items():
            signal.signal(kept, cast("signal.Handlers", handler))


def _end(code: int) -> None:
    """End at once, without waiting for threads and processes that still compute."""
    import multiprocessing

    for process in multiprocessing.active_children():
        process.terminate()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, OSError, ValueError):
            # a progress bar that is cut off has hidden the cursor
            stream.write("\x1b[?25h" if stream.isatty() else "")
            stream.flush()
    os._exit(code)
