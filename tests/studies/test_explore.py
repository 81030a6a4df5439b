"""The window to explore, off screen: its sliders are moved, and its panels show the physics."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from oscillators import slow

from studies import explore
from studies.shell.scene import read_scene

SLIDERS = ("frequency", "excess", "restitution")


@pytest.fixture
def seen() -> explore.Window:
    figure = Figure()
    FigureCanvasAgg(figure)
    return explore.Window(read_scene("letter", ["modes.count=4"]), figure)


def move(seen: explore.Window, **to: float) -> str:
    """Move sliders; returns what the title says then."""
    for name, value in to.items():
        seen.sliders[SLIDERS.index(name)].set_val(value)
    return seen.axes["t"].get_title(loc="left")


def test_the_motion_is_carried_over_grazing_and_down_to_its_fold(seen):
    """p4 of Eq. (1) remains from grazing down to -1.3211e-2, and is not there on the way up."""
    assert move(seen, frequency=21.5, excess=1e-3) == move(seen, excess=-0.0132) == "period 4"
    assert move(seen, excess=-0.015) == move(seen, excess=-0.0132) == "period 1"


def test_the_trace_meets_the_stop_once_a_period_and_the_strobes_repeat(seen):
    assert move(seen, frequency=20.9) == "period 3"
    trace, hits, stop = seen.axes["t"].lines
    times = np.asarray(hits.get_xdata())
    assert times.size == 4 and np.allclose(np.diff(times), 3.0, atol=1e-9)
    height = np.interp(times, *trace.get_data()) - stop.get_ydata()[0]
    assert np.all(np.abs(height) < np.max(np.abs(np.diff(trace.get_ydata()))))
    x, y = np.round(seen.axes["p"].lines[0].get_data(), 6)
    assert len(set(zip(x, y, strict=True))) == 3


@pytest.mark.slow
def test_the_diagram_has_the_hysteresis_of_p4(seen):
    move(seen, frequency=21.5, excess=-0.004)
    raised, _, lowered, _, here = seen.axes["d"].lines
    assert here.get_xdata()[0] == -0.004

    def branches(line, low, high):
        excess, tip = line.get_data()
        return {len(set(np.round(tip[excess == e], 6))) for e in set(excess) if low < e < high}

    assert branches(raised, -1.0, -1e-4) == {1} and branches(raised, 1e-4, 1.0) == {4}
    assert branches(lowered, -0.0129, 1.0) == {4} and branches(lowered, -1.0, -0.0135) == {1}


@pytest.mark.parametrize("kind", ["map", *slow(*list(explore.KINDS)[1:])])
def test_every_description_follows_its_sliders(seen, kind):
    seen.kind.set_active(list(explore.KINDS).index(kind))
    assert [move(seen, frequency=f) for f in (20.9, 22.2)] == ["period 3", "period 5"]
    strobes = seen.axes["p"].lines[0].get_data()
    move(seen, restitution=0.3)
    changed = not np.allclose(seen.axes["p"].lines[0].get_data(), strobes, atol=1e-4)
    assert changed == seen.axes["r"].get_visible() == (kind in ("map", "Eq. (1)"))


def test_what_cannot_be_computed_is_said_and_the_next_position_is_drawn(seen):
    seen.kind.set_active(0)
    assert "24.55 Hz" in move(seen, frequency=24.55)
    assert move(seen, frequency=22.2) == "period 5"


@pytest.mark.parametrize(("argv", "words"), [([], "display"), (["--set", "drive.kind=none"], "drive.kind")])
def test_without_a_window_or_a_drive_it_says_so_in_a_sentence(capsys, argv, words):
    plt.switch_backend("agg")
    assert explore.main(argv) == 2
    said = capsys.readouterr().err
    assert words in said and len(said.splitlines()) == 1
