"""One run of a study, seen from the study: what it gets besides its scene, and what it stores.

    results/NAME/summary.json     what was found; NaN and infinity are null
                 *.npz, *.csv     arrays and tables
                 *.png, *.pdf     figures, drawn from what was stored
                 columns.json     what each file and each column holds, with its unit
                 manifest.json    versions, parameters with provenance, command, commit, wall time

Everything for a person goes to standard error. What an interrupted study has stored until then stays.
"""

from __future__ import annotations

import io
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from beam import Refusal, SuspiciousValue
from contact import ContactError
from studies import letter
from studies.shell import files as store
from studies.shell.columns import columns_of, csv_text, print_table
from studies.shell.digits import numbers_in
from studies.shell.executors import pool_of, progress, say
from studies.shell.scene import Scene, of_the_letter
from studies.shell.scene.spring import size_in_words, spring_in_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Verdict = Literal["agrees", "in part", "differs", "fitted", "not printed"]

OWN_FILES = {
    "summary": "What was found.",
    "columns": "What each file and each column holds.",
    "manifest": "The command, the scene, versions and commit of these results.",
}  # what every study leaves

MOST_FINDINGS = 3
T = TypeVar("T")
S = TypeVar("S")


@dataclass(kw_only=True)
class Run:
    """What a study gets besides its scene; `files` lists what it has written, `scene` is the one it runs
    on."""

    study: str
    folder: Path
    scene: Scene
    command: str
    quick: bool = False
    workers: int = 1
    executor: str = ""
    style: str = "paper"
    options: Mapping[str, object] = field(default_factory=dict)
    warnings: Sequence[str] = ()
    files: list[str] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    model_choice: str = ""
    interrupted: bool = False
    closed: bool = False

    def __post_init__(self) -> None:
        store.require_writable(self.folder)
        self._settings = {"quick": self.quick, "style": self.style, **self.options}
        self._begun, self._date = time.perf_counter(), datetime.now(UTC)
        # of the scene as it was given, before modes are chosen
        self._fingerprint = store.fingerprint(self.scene.values(), self._settings)
        self._holds: dict[str, dict[str, object]] = {}
        self._verdicts: dict[str, dict[str, object]] = {}
        self._findings: list[str] = []

    # what a person sees

    say = staticmethod(say)

    def progress(self, unit: str, total: int) -> AbstractContextManager[Callable[..., None]]:
        """Count what `unit` names, in the plural."""
        return progress(self.study, total, unit)

    def warn(self, sentence: str) -> None:
        """Print a warning to standard error, and keep it in the summary."""
        self.warnings = [*self.warnings, sentence]
        self.say(f"warning: {sentence}")

    def track(self, items: Iterable[T], unit: str) -> Iterator[T]:
        """The items one after the other, each counted when it has been dealt with."""
        known = list(items)
        with self.progress(unit, len(known)) as tick:
            for item in known:
                yield item
                tick()

    # where it is computed

    def pool(self) -> AbstractContextManager[Executor]:
        """The executor that the command line names."""
        return pool_of(self.executor, self.workers)

    def map(self, function: Callable[[S], T], items: Iterable[S], unit: str) -> list[T]:
        """[function(item) for item in items] on the executor, in order, with progress."""
        known = list(items)
        with self.pool() as pool, self.progress(unit, len(known)) as tick:
            futures = [pool.submit(function, item) for item in known]
            for future in futures:
                future.add_done_callback(lambda _: tick())
            return [future.result() for future in futures]

    def attempt(self, function: Callable[[S], T], items: Iterable[S], unit: str) -> list[T | None]:
        """Like `map`; an item that ends with a ContactError or a Refusal counts as failed, and is None."""
        known = list(items)
        tried = self.map(partial(_tried, function), known, unit)
        for item, (_, error) in zip(known, tried, strict=True):
            if error:
                self.failed(f"{unit}, {item}", error)
        return [found for found, _ in tried]

    def adopt(self, scene: Scene, why: str) -> Scene:
        """Go on with this scene, a change of the one before; prints `why`."""
        self.scene = scene
        self.say(why)
        return scene

    def choose_modes(self, scene: Scene, why: str) -> Scene:
        """Go on with this scene, whose number of modes was chosen; keeps and prints `why`."""
        self.model_choice = why
        return self.adopt(scene, why)

    # what it leaves

    def path(self, name: str, holds: str, **more: object) -> Path:
        """The path of a file, or folder of files, that another library writes; `holds` says what is in it."""
        if Path(name).name != name:
            raise ValueError(f"a result needs a plain file name, not {name!r}")
        if name not in self.files:
            self.files.append(name)
        self._holds[name] = {"holds": holds, **more}
        return store.make_folder(self.folder) / name

    def text(self, name: str, text: str, holds: str) -> Path:
        """A text file under its full name."""
        return store.write_atomically(self.path(name, holds), text.encode())

    def json(self, name: str, value: object, holds: str) -> Path:
        """NAME.json."""
        return self.text(f"{name}.json", store.json_text(value) + "\n", holds)

    def arrays(self, name: str, holds: str, **arrays: ArrayLike) -> Path:
        """NAME.npz with these named arrays of numbers or texts; `holds` says what each of them is."""
        stream = io.BytesIO()
        known = {key: np.asarray(value) for key, value in arrays.items()}
        for key, array in known.items():
            if array.dtype.hasobject:
                raise TypeError(f"{key} in {name}.npz must be an array of numbers or texts, not of objects")
        np.savez_compressed(stream, **known)  # type: ignore[arg-type]
        path = self.path(f"{name}.npz", holds, arrays={key: array.shape for key, array in known.items()})
        return store.write_atomically(path, stream.getvalue())

    def table(
        self,
        name: str,
        rows: Sequence[T],
        caption: str,
        *,
        of: type,
        show: Sequence[str] | None = None,
        words: Mapping[str, str] | None = None,
    ) -> Path:
        """NAME.csv of rows of the dataclass `of`; on the terminal what to `show` (``columns``)."""
        columns = columns_of(of, rows, words)
        print_table(columns, rows, caption, show)
        about = [{"name": c.name, "heading": c.heading, "unit": c.unit, "note": c.note} for c in columns]
        path = self.path(f"{name}.csv", caption, columns=about)
        return store.write_atomically(path, csv_text(columns, rows).encode())

    def figure(self, name: str, figure: Figure, caption: str) -> None:
        """NAME.png and NAME.pdf; the caption is what the page writes below it."""
        from studies.shell.plotting import save  # matplotlib is slow to import

        for path in save(figure, store.make_folder(self.folder), name):
            self.path(path.name, caption)

    def failed(self, where: str, error: object, *, say: bool = True) -> None:
        """One failed cell: the study goes on, and ends with exit code 3."""
        self.failures.append(f"{where}: {' '.join(str(error).split()) or type(error).__name__}")
        if say:
            self.say(self.failures[-1])

    def verdict(self, point: str, verdict: Verdict, *, found: str, note: str = "", figure: str = "") -> None:
        """What was found of a point of the letter (`letter.POINTS`), if the spring is the letter's.

        "fitted": the scene was calibrated to that number; "not printed": the letter gives none to compare.
        `figure` is the name of the figure that shows it, by default the first of the study.
        """
        if point not in letter.POINTS or letter.POINTS[point].study != self.study:
            raise KeyError(f"{self.study} judges no point {point!r} of letter.POINTS")
        about: dict[str, object] = {"verdict": verdict, "found": found, "note": note, "figure": figure}
        self._verdicts |= {point: about} if self.letters else {}

    def finding(self, sentence: str) -> None:
        """A sentence for the page on what came out, with one number at most; a study has three at most."""
        if len(self._findings) == MOST_FINDINGS or len(numbers_in(sentence)) > 1:
            raise ValueError(f"a study has {MOST_FINDINGS} findings of one number each, not: {sentence}")
        self._findings.append(sentence)

    @cached_property
    def letters(self) -> bool:
        """Whether the scene is a spring of the letter."""
        with warnings.catch_warnings(
            action="ignore", category=SuspiciousValue
        ):  # it is driven as the letter's
            return of_the_letter(self.scene)

    @property
    def wall_time(self) -> float:
        """Seconds since the run began."""
        return time.perf_counter() - self._begun

    def close(self, status: str, results: Mapping[str, object]) -> dict[str, object]:
        """Write what every study leaves; returns the summary."""
        self.closed = True
        settings = {**self._settings, "workers": self.workers, "executor": self.executor}
        common = {"schema": store.SCHEMA, "study": self.study, "status": status, "settings": settings}
        common |= {"provenance": self.scene.provenance(), "warnings": list(self.warnings)}
        wall_time = round(self.wall_time, 3)
        summary = common | {"model_choice": self.model_choice, "failures": self.failures}
        summary["failed_cells"] = len(self.failures)
        summary |= {"verdicts": self._verdicts, "findings": self._findings}
        if taken := sorted(summary.keys() & results.keys()):
            raise ValueError(f"{self.study} returns {', '.join(taken)}, keys that every summary has already")
        summary |= results
        if status == "done" and "rows" not in results:
            raise ValueError(f"{self.study} returns no rows")
        for name, holds in OWN_FILES.items():
            self.path(f"{name}.json", holds)
        spring = {"spring": spring_in_words(self.scene), "size": size_in_words(self.scene)}
        manifest = common | {"command": self.command} | spring | {"of_the_letter": self.letters}
        manifest |= {"parameters": self.scene.values(), "versions": store.versions()}
        manifest |= {"git": store.git_state(), "fingerprint": self._fingerprint}
        begun = self._date.isoformat(timespec="seconds")
        manifest |= {"begun": begun, "wall_time_s": wall_time, "files": self.files}
        for (name, holds), value in zip(OWN_FILES.items(), (summary, self._holds, manifest), strict=True):
            self.json(name, value, holds)
        return {**summary, "folder": self.folder, "wall_time_s": wall_time}


def _tried(function: Callable[[S], T], item: S) -> tuple[T | None, str]:
    """The value of an item, or None and why there is none."""
    try:
        return function(item), ""
    except (ContactError, Refusal) as error:
        return None, str(error) or type(error).__name__
