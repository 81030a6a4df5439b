"""Whether coverage is counted right, and what the ways to a gradient through impacts are worth."""

from __future__ import annotations

import pickle
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from beam import InvalidValue
from studies.measurement.identify import coverage as truth
from studies.shell.run import Run
from studies.shell.scene import read_scene


@pytest.fixture(scope="module")
def trials():
    """By name; the beam with four modes."""
    scene = read_scene("letter", ["modes.count=4"])
    return {trial.name: trial for trial in truth.trials(scene, scene)}


@pytest.fixture
def run(tmp_path, letter_scene):
    how = dict(quick=True, workers=2, executor="threads", options={}, warnings=[], command="")
    return Run(study="identify", folder=tmp_path, scene=letter_scene, **how)


@pytest.mark.parametrize(("stated", "agrees"), [(1.0, True), (0.8, False), (1.25, False)])
def test_errors_stated_wrong_are_seen(stated, agrees, trials, run, letter_scene, monkeypatch):
    """Normal estimates with errors said to be `stated` times what they are; one in twenty is refused."""
    trial = replace(trials["Eq. (1), strobe"], truth={"gap": 5.0})
    random = np.random.default_rng(3)

    def fit(record, start, names):
        if random.random() < 0.05:
            raise InvalidValue("refused")
        at, error = np.array([random.normal(5.0, 0.1)]), np.array([0.1 * stated])
        ends = at[:, None] + 1.645 * np.array([-error, error]).T
        return SimpleNamespace(estimate=at, errors=error, intervals=lambda: ends, too_small=False)

    monkeypatch.setattr(truth, "fit", fit)
    monkeypatch.setattr(truth, "trials", lambda *scenes: iter([trial]))
    (row,) = truth.coverage(letter_scene, letter_scene, run, records=2000, beam_records=1)
    assert row.agrees is agrees and row.records == 2000 and 60 < row.refused < 140
    assert row.spread == pytest.approx(1.0 / stated, rel=0.05) and abs(row.bias) < 0.1

    def again(*_):
        raise AssertionError("what is stored is fitted again")

    monkeypatch.setattr(truth, "fit", again)
    assert truth.coverage(letter_scene, letter_scene, run, records=2000, beam_records=1) == [row]


def test_a_record_depends_on_its_trial_and_its_number_alone(trials, monkeypatch):
    """The same in another process."""
    monkeypatch.setattr(truth, "CHUNK", 2)
    trial = trials["Eq. (1), transitions"]
    again = pickle.loads(pickle.dumps(trial.column))(2, 1)
    first, other, later = (trial.column(*at) for at in ((2, 1), (3, 1), (2, 2)))
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert np.unique(np.concatenate([one["estimate"][:, 0] for one in (first, other, later)])).size == 6


def test_errors_are_those_of_the_scatter_over_many_records(trials, monkeypatch):
    """32 records: the variance of each estimate over its reported one is chi^2/32, 1 +- 0.25."""
    monkeypatch.setattr(truth, "CHUNK", 32)
    trial = trials["Eq. (1), strobe"]
    found = trial.column(0, 0)
    pulls = (found["estimate"] - np.array(list(trial.truth.values()))) / found["error"]
    assert np.all(np.abs(np.mean(pulls**2, axis=0) - 1.0) < 0.55)
    assert np.all(np.abs(pulls.mean(axis=0)) < 4.0 / np.sqrt(32.0)) and not found["small"].any()


@pytest.mark.parametrize("kind", [pytest.param("strobe", marks=pytest.mark.slow), "displacement"])
def test_one_mode_is_too_small_for_the_beam_and_its_own_modes_are_not(trials, monkeypatch, kind):
    monkeypatch.setattr(truth, "CHUNK", 3)
    for name, small in {f"beam, {kind}, by Eq. (1)": 3, f"beam, {kind}": 0}.items():
        found = trials[name].column(0, 0)
        assert np.all(np.isfinite(found["error"])) and found["small"].sum() == small
        off = (found["estimate"] - np.array(list(trials[name].truth.values()))) / found["error"]
        assert small or np.abs(off).max() < 3.5
