"""Studies as a person runs them, in this process."""

import csv
import importlib
import json
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from page_judge import assert_fit

from beam import ModalModel
from studies.letter import POINTS
from studies.shell import plotting
from studies.shell.page import write_page
from studies.shell.programs import module_of
from studies.shell.run import Run
from studies.shell.scene import Scene, model_of, read_scene
from studies.shell.study import Study

VERDICTS = {
    "agrees": "p3 p4 p5 p6 p8 period_adding coexistence chaos last_period bands neighbour_band time_trace "
    "many_modes restitution_on_orbit secondary universality soft_wall sampled",
    "in part": "torsion hysteresis restitution loss breakdown breakdown_p3 island smoothing two_parameters "
    "two_parameters_born",
    "differs": "p10",
    "fitted": "free_period drive_amplitude",
    "not printed": "delay",
}
EXPECTED = {key: verdict for verdict, keys in VERDICTS.items() for key in keys.split()}


def verdicts_on(study: str) -> dict[str, str]:
    """Point of the letter -> verdict that a study must give; empty if it judges none."""
    return {key: EXPECTED[key] for key, point in POINTS.items() if point.study == study}


@dataclass(frozen=True, kw_only=True)
class Ran:
    """What a run left: exit code, summary and manifest (empty if there are none), folder, both streams."""

    code: int
    summary: dict
    manifest: dict
    folder: Path
    out: str
    err: str

    @property
    def verdicts(self) -> dict[str, str]:
        """Point of the letter -> verdict."""
        return {point: entry["verdict"] for point, entry in self.summary["verdicts"].items()}

    def rows(self, name: str) -> list[dict[str, str]]:
        """The rows of NAME.csv."""
        with (self.folder / f"{name}.csv").open(newline="") as stream:
            return list(csv.DictReader(stream))

    def arrays(self, name: str) -> dict[str, np.ndarray]:
        """The arrays of NAME.npz."""
        with np.load(self.folder / f"{name}.npz") as stored:
            return dict(stored)


def study_of(name: str) -> Study:
    """The study with this name."""
    found = getattr(importlib.import_module(module_of(name)), name)
    assert isinstance(found, Study)
    return found


def assert_complete(name: str, folder: Path, summary: dict, manifest: dict) -> None:
    """A study that ends well leaves every file that it lists, a table, a figure and a summary; what each file
    and each column holds; one value in each cell; one to three findings; a page."""
    files = [folder / file for file in manifest.get("files", [])]
    assert all(path.exists() for path in files)
    holds = json.loads((folder / "columns.json").read_text())
    assert set(holds) == set(manifest["files"]) and all(about["holds"] for about in holds.values())
    for path in (path for path in files if path.suffix == ".csv"):
        with path.open(newline="") as stream:
            heading, *rows = csv.reader(stream)
        own = [column["name"] for column in holds[path.name].get("columns", ())]
        assert heading == own or name == "identify", path  # its records have a format of their own
        assert not [cell for row in rows for cell in row if cell[:1] in ("[", "{", "(")], path
    assert isinstance(summary["rows"], list) and (summary["findings"] or name == "work_precision")
    assert_fit(write_page(folder.parent)[0])
    assert any(path.suffix == ".csv" and path.stat().st_size > 20 for path in files)
    assert any(path.suffix == ".png" and path.stat().st_size > 2000 for path in files) or name == "calibrate"
    assert summary["study"] == name and not any(key.startswith("wall") for key in summary)


def draw_quickly(figure: Figure, folder: Path, name: str) -> tuple[Path]:
    """A png of few dots instead of `plotting.save`: what is drawn is the same, and fonts take no second."""
    with matplotlib.rc_context(plotting.STYLE):
        figure.savefig(folder / f"{name}.png", dpi=40)
    return (folder / f"{name}.png",)


def portable_map(run: Run, function, items, label, of=Run.map):
    """`Run.map`, with what is mapped sent as to another process: nothing of it may live in `__main__`."""
    sent = pickle.dumps((function, list(items)))
    assert b"__main__" not in sent, f"{label}: {function}"
    return of(run, *pickle.loads(sent), label)


@pytest.fixture
def run_study(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Callable[..., Ran]:
    """`run_study(name, *argv)`: the study in its own folder, on the letter's scene by default."""

    def run(name: str, *argv: str) -> Ran:
        monkeypatch.setattr(plotting, "save", draw_quickly)
        if "--quick" in argv:
            monkeypatch.setattr(Run, "map", portable_map)
        code = study_of(name).main([*argv, "--out", str(tmp_path)])
        out, err = capsys.readouterr()
        folder, found = tmp_path / name, []
        for file in ("summary.json", "manifest.json"):
            found.append(json.loads((folder / file).read_text()) if (folder / file).exists() else {})
        if code == 0 and found[0] and "--shard" not in argv:  # --help runs nothing, a shard is a part
            assert_complete(name, folder, *found)
        return Ran(code=code, summary=found[0], manifest=found[1], folder=folder, out=out, err=err)

    return run


@pytest.fixture(scope="session")
def letter_scene() -> Scene:
    """The letter's scene."""
    return read_scene("letter")


@pytest.fixture(scope="session")
def letter_model(letter_scene: Scene) -> ModalModel:
    """The modal model of the letter's scene."""
    return model_of(letter_scene)
