"""The studies as programs: their names, their docstrings, and how they refuse.

A study is a file of this folder, or a folder with a `__main__`, that runs: nothing lists them. Nothing of
this imports a study.

Exit codes: 0 done; 2 wrong use (a `beam.Refusal`, or a file that cannot be read or written), in one sentence;
3 finished with failed cells; 130 interrupted. Any other error is a fault of the program and shows its
traceback. With --json standard output carries one JSON object and nothing else; everything for a person goes
to standard error. GRAZING_SPRING_TRACEBACK=1 shows where a refused input was noticed.
"""

from __future__ import annotations

import ast
import contextlib
import csv
import os
import re
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import TextIO

import studies as package
from beam import Refusal
from studies.shell.files import SCHEMA, json_text

DONE, WRONG_USE, FAILED_CELLS, INTERRUPTED = 0, 2, 3, 130
TRACEBACK = "GRAZING_SPRING_TRACEBACK"

FOLDER = Path(__file__).resolve().parent.parent
RUN_TIMES = FOLDER / "shell" / "run_times.csv"
"""The measured run times, the studies of each chapter in the order of their argument."""

CHAPTERS = ("experiment", "spring", "methods", "measurement")
TOOLS = ("report", "tour", "explore", "pictures")
"""Programs without results of a scene."""

STUDY = re.compile(r"^@study\(", re.MULTILINE)
"""What a file of a study has."""

MAIN = "transitions"
"""What `python -m studies` runs."""

MODULE = "python -m studies"
COMMAND = "grazing-spring" if Path("".join(sys.argv[:1])).stem == "grazing-spring" else MODULE
"""What runs the main job, and with a NAME any program: as this process was started."""

ALL = f"{COMMAND} --all"
"""What runs every study."""


def needs(what: str, packages: str) -> str:
    """The sentence on missing packages of an extra, with the command that installs them."""
    return f"{what} needs {packages}: python -m pip install {packages}"


def chapter(name: str) -> dict[str, Path]:
    """The studies of a chapter in the order of the table of run times: name -> the file that runs."""
    found = {path.stem: path for path in (FOLDER / name).glob("[a-z]*.py")}
    found |= {path.parent.name: path for path in (FOLDER / name).glob("[a-z]*/__main__.py")}
    order = [line.partition(",")[0] for line in RUN_TIMES.read_text("utf-8").splitlines()]
    known = sorted(found, key=lambda one: (order.index(one) if one in order else len(order), one))
    return {one: found[one] for one in known if STUDY.search(found[one].read_text("utf-8"))}


@cache
def programs() -> dict[str, Path]:
    """Every program that runs as `python -m studies NAME`, and its file; nothing else lists them."""
    found = {name: path for each in CHAPTERS for name, path in chapter(each).items()}
    return found | {name: FOLDER / f"{name}.py" for name in TOOLS}


def names() -> list[str]:
    """The names of all programs."""
    return sorted(programs())


def studies() -> list[str]:
    """Every study, by chapter; the first is the main one."""
    return [name for each in CHAPTERS for name in chapter(each)]


def first_line(path: Path) -> str:
    """The first line of a file's docstring."""
    return (ast.get_docstring(ast.parse(path.read_text("utf-8"))) or "").partition("\n")[0]


def chapters_in_words() -> str:
    """The chapters with one line for each study, then the tools."""
    found = {first_line(FOLDER / name / "__init__.py"): chapter(name) for name in CHAPTERS}
    found["Tools"] = {name: programs()[name] for name in TOOLS}
    lines = {
        title: [f"    {n:<18} {first_line(path)}" for n, path in own.items()] for title, own in found.items()
    }
    return "\n\n".join("\n".join([title, *own]) for title, own in lines.items())


def overview() -> str:
    """The answer to --help without a name: the programs, and where their options are listed."""
    return f"""{chapters_in_words()}

{COMMAND} NAME           run one of them; its options: {COMMAND} NAME --help
{COMMAND}                run {MAIN}; its options: {COMMAND} {MAIN} --help
{COMMAND} --all          run every study; its options: {ALL} --help
{COMMAND} --dump-scene   print the scene of the letter, to be changed for another spring"""


def by_own_name(text: str) -> str:
    """The text with the command as this process was started."""
    return text.replace(MODULE, COMMAND)


def account_of(name: str) -> str:
    """What a study says of itself: its docstring."""
    return by_own_name(ast.get_docstring(ast.parse(programs()[name].read_text("utf-8"))) or "")


def run_times(table: Path = RUN_TIMES) -> dict[str, tuple[float, float]]:
    """Run times [s] of each study in full and with --quick; 60 s and 10 s for a study not in the table.

    `python -m studies --all` measures them; the table was measured on two cores, with compiled kernels.
    """
    with table.open(newline="", encoding="utf-8") as stream:
        found = {name: (float(full), float(quick)) for name, full, quick in list(csv.reader(stream))[1:]}
    return {name: found.get(name, (60.0, 10.0)) for name in studies()}


def in_words(seconds: float) -> str:
    """A run time for a person: 8 s, 35 s, 2 min, 3.5 min."""
    if seconds < 57.5:
        return f"{max(round(seconds) if seconds < 10.0 else 5 * round(seconds / 5.0), 1)} s"
    return f"{0.5 * round(seconds / 30.0):g} min"


def run_time_of(names: Sequence[str]) -> str:
    """The sentence on the run time of these studies for `--help`; empty if there is none."""
    known = run_times()
    full, quick = (sum(known[name][form] for name in names if name in known) for form in (0, 1))
    return f"Run time: {in_words(full)}, with --quick {in_words(quick)}, on two cores." if full else ""


def module_of(name: str) -> str:
    """The module of a program, for an import."""
    return ".".join(("studies", *programs()[name].relative_to(FOLDER).with_suffix("").parts))


def unknown(name: str) -> str:
    """The sentence on a study that does not exist, with the nearest name."""
    found = get_close_matches(name[:100], names(), n=1, cutoff=0.6)
    return f"there is no study {name[:100]}" + (f"; did you mean {found[0]}?" if found else "")


def perform(study: str, command: str, arguments: Sequence[str], work: Callable[[TextIO], int]) -> int:
    """The exit code of `work`, which prints to the stream that it gets; wrong use becomes one sentence."""
    with _clean_output() as output:
        try:
            return work(output)
        except SystemExit:  # --help
            return DONE
        except (Refusal, OSError) as error:
            if os.environ.get(TRACEBACK) == "1":
                traceback.print_exc()
            sentence = " ".join(str(error).split()) or f"{type(error).__name__} without a message"
            print(f"{command}: {sentence}", file=sys.stderr)
            if "--json" in arguments:
                refusal = {"status": "refused", "error": sentence, "exit_code": WRONG_USE}
                print_answer({"schema": SCHEMA, "study": study, **refusal}, output)
            return WRONG_USE


def refuse_arguments(name: str, arguments: Sequence[str]) -> None:
    """For a script without options: --help prints its account, any other argument is refused."""
    if arguments and arguments[0] in ("-h", "--help"):
        print_answer(account_of(name), sys.stdout)
        raise SystemExit(DONE)
    if arguments:
        print(f"{COMMAND} {name}: {arguments[0]} is refused; it takes no options", file=sys.stderr)
        raise SystemExit(WRONG_USE)


def as_program() -> bool:
    """Whether this process was started to run a study."""
    return package.program


@contextlib.contextmanager
def _clean_output() -> Iterator[TextIO]:
    """Yield standard output; what is printed meanwhile, even by a library, goes to standard error."""
    wanted = sys.stdout
    if not as_program():
        with contextlib.redirect_stdout(sys.stderr):
            yield wanted
        return
    wanted.flush()
    kept = os.dup(1)
    os.dup2(2, 1)
    try:
        with contextlib.redirect_stdout(sys.stderr), open(os.dup(kept), "w", encoding="utf-8") as output:
            yield output
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def print_answer(answer: object, output: TextIO) -> None:
    """Print the answer, a text or what JSON takes; a pipe whose reader has seen enough (head) is no error."""
    try:
        print(answer if isinstance(answer, str) else json_text(answer), file=output, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())
