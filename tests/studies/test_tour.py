"""The tour runs from top to bottom, and what it prints is what the physics requires."""

import contextlib
import io
import re
import runpy
from pathlib import Path

import numpy as np
import pytest

from studies.letter import PERIODS

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "studies" / "tour.py"


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    """What the script leaves behind, run in a folder of its own."""
    folder = tmp_path_factory.mktemp("tour")
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()) as printed:
        patch.chdir(folder)
        found = runpy.run_path(str(SOURCE))
    return {**found, "run_in": folder, "printed": printed.getvalue()}


def test_the_start_page_shows_what_it_prints(names):
    """All but the files at the end; rounding decides how well the orbit repeats."""
    blocks = re.findall(r"```text\n(.*?)```", (ROOT / "docs" / "start.md").read_text("utf-8"), re.DOTALL)
    shown, printed = (re.sub(r"\de-\d+ m", "", text) for text in ("".join(blocks), names["printed"]))
    assert shown and printed.removeprefix(shown).startswith("drawn in")


def test_the_orbit_is_that_of_the_letter(names):
    """One impact in four periods, a motion that repeats then and not before."""
    period = PERIODS[21.50]
    again = names["again"]
    assert sorted(again.impacts[:period]) == [0] * (period - 1) + [1]
    assert np.array_equal(again.impacts[period:], again.impacts[:period])
    steps = np.abs(again.points[period:] - again.points[:period]).max(axis=1)
    assert steps.max() < 1e-12
    assert np.abs(again.points[2] - again.points[0]).max() > 1e-4


def test_it_ends_at_a_fold_below_grazing(names):
    fold = names["fold"]
    assert -0.02 < fold.excess < -0.005
    assert abs(fold.multipliers[0] - 1.0) < 1e-5
    assert all(abs(m) < 1.0 for m in fold.multipliers[1:])


def test_the_sampled_motion_stays_before_the_plate_but_for_the_dent_of_the_contact(names):
    height = names["motion"].displacement @ names["model"].phi
    gap = names["oscillator"].stop.gap
    assert 0.98 * gap < height.max() < gap + 1e-4
    assert names["hit"].impacts == 1
    assert (names["run_in"] / "results" / "tour.png").stat().st_size > 5000
