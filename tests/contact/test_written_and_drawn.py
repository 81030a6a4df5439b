"""Motions, scans and branches as tables, files and pictures."""

import csv
import sys
from dataclasses import replace
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from oscillators import GAMMA, GAP, LIGHT, OMEGA, modes_on_stop

from beam import InvalidValue
from contact import LinearContact, StroboscopicMap, Trajectory, simulate
from contact.errors import BranchEnded
from contact.orbits import Shooting, fold_of, follow, orbit_diagram

matplotlib.use("agg")
LAW = LinearContact(stiffness=1e5, damping=20.0)
RIG = modes_on_stop(OMEGA[:2], (3.5, 20.0), LIGHT[:2], GAMMA[:2], gap=GAP, law=LAW, drive=21.5).with_excess(
    0.02
)
RUN = simulate(RIG, periods=30, times=np.linspace(0.0, 0.5, 8001))


def rows_of(path):
    """Heading and columns of a csv file."""
    heading, *rows = csv.reader(path.read_text("utf-8").splitlines())
    return heading, list(zip(*rows, strict=True))


def test_the_tip_is_the_sum_of_the_modes_and_its_velocity_its_derivative():
    assert np.array_equal(RUN.tip, RUN.displacement @ RIG.model.phi)
    step = RUN.time[1]
    smooth = np.ones(RUN.time.size - 2, dtype=bool)
    for begin, end in zip(RUN.impacts.start, RUN.impacts.end, strict=True):  # there the acceleration changes
        smooth &= (RUN.time[1:-1] < begin - 2.0 * step) | (RUN.time[1:-1] > end + 2.0 * step)
    slope = (RUN.tip[2:] - RUN.tip[:-2]) / (2.0 * step)
    assert np.abs(slope - RUN.tip_velocity[1:-1])[smooth].max() < 3e-4 * np.abs(RUN.tip_velocity).max()


def test_tables_hold_every_digit(tmp_path):
    RUN.to_csv(tmp_path / "tip.csv")
    heading, columns = rows_of(tmp_path / "tip.csv")
    assert heading == ["time [s]", "tip [m]", "tip_velocity [m/s]"]
    assert np.array_equal(np.array(columns, dtype=float), [RUN.time, RUN.tip, RUN.tip_velocity])
    RUN.impacts.to_csv(tmp_path / "impacts.csv")
    heading, columns = rows_of(tmp_path / "impacts.csv")
    found = dict(zip(heading, columns, strict=True))
    assert len(RUN.impacts) > 5 and set(found["kind [1]"]) == {"IMPACT"}
    for name in ("start [s]", "approach [m/s]", "peak_force [N]", "loss [J]"):
        assert np.array_equal(np.array(found[name], dtype=float), getattr(RUN.impacts, name.split()[0]))


def test_a_file_gives_the_same_motion_back(tmp_path):
    RUN.save(tmp_path / "run.npz")
    again = Trajectory.load(tmp_path / "run.npz", RIG)
    for name in ("strobe_displacement", "strobe_impacts", "tip", "tip_velocity"):
        assert np.array_equal(getattr(again, name), getattr(RUN, name))
    assert np.array_equal(again.impacts.peak_force, RUN.impacts.peak_force) and repr(again) == repr(RUN)
    further = [simulate(RIG, one.end, periods=5).strobe_displacement for one in (RUN, again)]
    assert np.array_equal(*further)
    with pytest.raises(InvalidValue, match="oscillator has other numbers"):
        Trajectory.load(tmp_path / "run.npz", RIG.with_excess(0.03))
    with pytest.raises(InvalidValue, match=r"must end with \.npz; for a table use to_csv"):
        RUN.save(tmp_path / "run.csv")


def test_pandas_is_used_if_it_is_there(monkeypatch):
    """Its DataFrame gets the columns; without it the sentence names the remedy."""
    frames = SimpleNamespace(DataFrame=lambda columns: SimpleNamespace(columns=columns, attrs={}))
    monkeypatch.setitem(sys.modules, "pandas", frames)
    frame = RUN.impacts.to_dataframe()
    assert frame.columns["approach"] is RUN.impacts.approach and frame.attrs["units"]["approach"] == "m/s"
    assert list(RUN.to_dataframe().columns) == ["time", "tip", "tip_velocity"]
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="needs the package pandas: python -m pip install pandas"):
        RUN.impacts.to_dataframe()


def test_the_picture_of_a_motion_shows_tip_stop_and_impacts():
    axes = RUN.plot()
    motion, *others = axes.lines
    assert np.array_equal(motion.get_xydata(), np.transpose([RUN.time, 1e3 * RUN.tip]))
    across = [line.get_ydata()[0] for line in others if line.get_label() == "stop"]
    upright = [line.get_xdata()[0] for line in others if line.get_label() != "stop"]
    assert across == [1e3 * GAP] and upright == RUN.impacts.start.tolist()
    assert axes.get_legend_handles_labels()[1] == ["motion", "impact", "stop"]
    assert RUN.plot(axes) is axes
    with pytest.raises(InvalidValue, match="trajectory was made without times; give some"):
        simulate(RIG, periods=3).plot()


def test_the_picture_of_a_scan_pales_what_did_not_settle():
    strobed = StroboscopicMap(oscillator=RIG)
    scan = orbit_diagram(
        strobed, [-1e-3, 2e-3], strobed.at(-1e-3).steady(), observe=strobed.tip, settle_cycles=500
    )
    moving = replace(scan, m=np.array([1, 0]))
    bold, pale = moving.plot(label="raised", color="red").lines
    assert np.array_equal(bold.get_ydata(), scan.points[0]) and bold.get_alpha() == 1.0
    assert np.array_equal(pale.get_ydata(), scan.points[1]) and pale.get_alpha() < 0.5
    assert (bold.get_label(), pale.get_label(), pale.get_color()) == ("raised", "pale: not settled", "red")


def test_a_family_alone_is_enough_for_its_whole_branch():
    """From a graze over the fold to touches that hardly feel the gap; the fold is that of the search."""
    family = Shooting(oscillator=RIG, m=4)
    branch = follow(family)
    fold = fold_of(family)
    assert fold is not None and branch.of_kind("fold")[0].excess == pytest.approx(fold.excess, rel=1e-8)
    speeds = [orbit.speed / RIG.unit_speed for orbit in branch.orbits]
    assert speeds[0] < 2e-6 and speeds[-1] > 50.0 and np.all(np.diff(speeds) > 0.0)
    part = follow(family, fold, low=0.5 * fold.speed)
    assert part.orbits[-1].speed / RIG.unit_speed > 50.0 and part.orbits[0].speed > 0.499 * fold.speed
    axes = branch.plot()
    drawn = {line.get_label(): line.get_linestyle() for line in axes.lines}
    assert drawn["stable"] == "-" and drawn["unstable"] == "--"
    for line in axes.lines:
        kind = {"stable": (True, True), "unstable": (False, True)}.get(line.get_label())
        inner = {(x, y) for x, y in line.get_xydata()[:-1].tolist()}
        on = [orbit for orbit in branch.orbits if (orbit.excess, 1e3 * orbit.speed) in inner]
        assert kind is None or (on and all((o.stable, o.admissible) == kind for o in on))
    assert f"fold at {fold.excess:#.3g}" in repr(branch) and "fold" in {one.get_text() for one in axes.texts}
    with pytest.raises(BranchEnded, match="no orbit of period 1 was found to start from"):
        follow(Shooting(oscillator=RIG, m=1, impacts=40))
