"""Every study in turn on one scene, then the page of all their results.

    python -m studies --all [--scene FILE.toml] [--set section.key=value ...] [--quick] [--out DIR] [--fresh]

Each study runs in a process of its own, with its options at their defaults; the main job is the first. A
study that is stored as done, of the same scene, options and source, is not run again, unless with --fresh:
the same command goes on where Ctrl-C stopped it, and tries again what was refused or had failed cells.
Programs without results of a scene (`report`, `export`, `tour`) are no studies. The time left is estimated
from `studies/shell/run_times.csv` and the speed so far. The measured run times go to DIR/run_times.csv.

Exit codes: 0 done; 2 wrong use; 3 a study failed, was refused or has failed cells; 130 interrupted.

Run:     python -m studies --all
Writes:  DIR/NAME/ of each study, DIR/report/index.html, DIR/run_times.csv
"""

from __future__ import annotations

import importlib
import json
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import types
from argparse import Namespace
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TextIO

from studies.shell import programs
from studies.shell.executors import duration, progress, say
from studies.shell.files import SCHEMA, fingerprint, make_folder, write_atomically
from studies.shell.options import parser_of
from studies.shell.page import page_sentence
from studies.shell.programs import DONE, FAILED_CELLS, INTERRUPTED, print_answer, run_times, studies
from studies.shell.scene import Scene
from studies.shell.study import Study, scene_and_doubts

OWN_OPTIONS = ("--all", "--fresh", "--json")
"""Not passed on to the studies."""


def arguments_of(name: str, scene: Scene, given: Namespace, passed_on: Sequence[str]) -> list[str] | None:
    """Arguments of a study, None if it is stored; after a change of scene or source it begins anew."""
    study: Study = getattr(importlib.import_module(programs.module_of(name)), name)
    settings = {"quick": given.quick, "style": given.style, **study.defaults(given.quick)}
    try:
        there = json.loads((Path(given.out) / name / "manifest.json").read_text(encoding="utf-8"))
        same = not given.fresh and there["fingerprint"] == fingerprint(scene.values(), settings)
        if same and there["status"] == "done":
            return None
    except (OSError, ValueError, TypeError, KeyError):  # nothing is there, or nothing of ours
        same = False
    return [*passed_on, *(["--fresh"] if "fresh" in settings and not same else [])]


def run_in_turn(
    plan: Mapping[str, Sequence[str]], quick: bool
) -> tuple[dict[str, int], dict[str, float], bool]:
    """Run the studies with these arguments.

    Returns the exit codes by study, the run times [s] of the studies that ended with code 0, and whether a
    signal ended the series.

    Each has a process group of its own, so that Ctrl-C reaches it once, passed on from here: it stores what
    it has and ends.
    """
    codes, took = dict[str, int](), dict[str, float]()
    running, stopped, known = list[subprocess.Popen[bytes]](), False, run_times()

    def signalled(number: int, frame: types.FrameType | None) -> None:
        nonlocal stopped
        stopped = True
        for child in running:
            child.send_signal(number)

    expected = {name: round(known[name][quick]) for name in plan}
    say(f"{len(plan)} studies to run, about {duration(sum(expected.values()))}")
    with ExitStack() as after, progress("all studies", sum(expected.values()), "s") as tick:
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) is not signal.SIG_IGN:
                after.callback(signal.signal, number, signal.signal(number, signalled))
        for name, arguments in plan.items():
            if stopped:
                break
            label, begun = f"{programs.COMMAND} {name}", time.monotonic()
            command, quiet = [sys.executable, "-m", "studies", name, *arguments], subprocess.DEVNULL
            with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as log:
                child = subprocess.Popen(command, stdin=quiet, stdout=log, stderr=log, process_group=0)
                running[:] = [child]
                codes[name] = child.wait()
                tick(expected[name])  # however long it took
                if codes[name] == DONE:
                    took[name] = time.monotonic() - begun
                log.seek(0)
                lines = programs.by_own_name(log.read()).splitlines()
                last = next((line for line in reversed(lines) if line.strip()), "")
            say(last if last.startswith(label) else f"{label}: exit code {codes[name]}; {last.strip()}")
    return codes, took, stopped


def keep_times(took: Mapping[str, float], quick: bool, table: Path) -> None:
    """Write the run times `took` [s] into the csv file `table`; its other numbers stay as they are."""
    rows = run_times(table) if table.exists() else run_times()
    rows |= {name: (rows[name][0], new) if quick else (new, rows[name][1]) for name, new in took.items()}
    lines = [f"{name},{full:.0f},{small:.0f}\n" for name, (full, small) in rows.items()]
    write_atomically(table, "".join(["study,full_s,quick_s\n", *lines]).encode())


def run_all(given: Namespace, arguments: Sequence[str], output: TextIO) -> int:
    """Run what is not stored and write the page; returns the exit code."""
    begun = time.monotonic()
    scene, doubtful = scene_and_doubts(given.scene, given.overrides)
    passed_on = [word for word in arguments if word not in OWN_OPTIONS]
    found = {name: arguments_of(name, scene, given, passed_on) for name in studies()}
    stored = [name for name, arguments in found.items() if arguments is None]
    known = [f"stored already: {', '.join(stored)}"] if stored else []
    for sentence in [*(f"warning: {doubt}" for doubt in doubtful), *known]:
        say(sentence)
    plan = {name: arguments for name, arguments in found.items() if arguments is not None}
    codes, took, stopped = run_in_turn(plan, given.quick)
    keep_times(took, given.quick, make_folder(Path(given.out)) / "run_times.csv")
    failed = [name for name, code in codes.items() if code != DONE]
    code = INTERRUPTED if stopped else FAILED_CELLS if failed else DONE
    status = {DONE: "done", FAILED_CELLS: "finished with failed studies", INTERRUPTED: "interrupted"}[code]
    again = shlex.join([*programs.COMMAND.split(), *(word for word in arguments if word != "--fresh")])
    rest = f"; go on with: {again}" if stopped else f": {', '.join(failed)}" if failed else ""
    say(f"{programs.ALL}: {status} after {duration(time.monotonic() - begun)}{rest}")
    say(page_sentence(Path(given.out)))
    if given.json:
        answer = {"schema": SCHEMA, "study": "all", "status": status, "stored": stored}
        print_answer({**answer, "exit_codes": codes, "exit_code": code}, output)
    return code


def main(arguments: Sequence[str]) -> int:
    """Read the arguments of `python -m studies --all` and run the studies; returns the exit code."""

    def work(output: TextIO) -> int:
        parser = parser_of(programs.ALL, f"{__doc__}\n{programs.run_time_of(studies())}")
        parser.add_argument("--all", action="store_true", help="every study instead of the main job")
        parser.add_argument("--fresh", action="store_true", help="run again what is stored, too")
        return run_all(parser.read(arguments, output), arguments, output)

    return programs.perform("all", programs.ALL, arguments, work)
