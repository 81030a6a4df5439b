"""Figures at the standard of a journal: axes with units, no colour alone, no cut words, the data beside them.

Drawing functions get small made-up rows; `complaints` walks through what they return as a referee would, and
is itself tried on figures with one planted fault each.
"""

from __future__ import annotations

import ast
import csv
import functools
import itertools
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.text import Text

from contact.orbits.scan import OrbitDiagram
from studies import ROOT
from studies.instruments import hysteresis_figures, trace_figure, transition_figures
from studies.instruments.benchmarks.cost_figure import draw_costs
from studies.instruments.drawn_points import axis_words, drawn_maps, drawn_points, name_of
from studies.instruments.effective_impact.figures import speed
from studies.instruments.figures import (
    GUIDE,
    LETTER_POINTS,
    PALETTE,
    STYLE,
    in_house_style,
    label,
    mark_letter,
    new_figure,
    panel,
    points,
    series,
)
from studies.instruments.hysteresis_causes import CAUSES
from studies.instruments.record import Record
from studies.instruments.scene_file import read_scene
from studies.instruments.sensitivity.noise_figures import draw_noise
from studies.instruments.sensitivity.tornado_figure import draw_tornado
from studies.instruments.settled_trace import CloseUp, Trace
from studies.instruments.soft_wall import figures as soft_wall
from studies.published import PERIODS

SIZES = {float(STYLE["font.size"]), float(STYLE["xtick.labelsize"])}
DIMENSIONS = re.compile(r"^(time|frequency|delay|velocity|speed|displacement|force|mass)\b(?!.*/)")
"""Quantities that have a unit, unless they are ratios."""

LARGEST_FILE = 2_000_000
"""Bytes of a table of drawn points."""


# what a referee would say


def _in_data(axes: Axes, artist: Any) -> bool:
    return bool(all(artist.get_transform().contains_branch_seperately(axes.transData)))


def _capless(axes: Axes) -> Iterator[Any]:
    """The lines in values of the axes, without the caps of error bars."""
    caps = {cap for c in axes.containers if hasattr(c, "lines") for cap in c.lines[1]}
    return (line for line in axes.lines if line not in caps and _in_data(axes, line))


def _name(axes: Axes, line: Any) -> str:
    bars = [c for c in axes.containers if hasattr(c, "lines") and c.lines[0] is line]
    return name_of(bars[0]) if bars else name_of(line)


def _quantities(axes: Axes, number: int) -> Iterator[str]:
    for which in "xy":
        words, own = axis_words(axes, which), getattr(axes, f"{which}axis").label
        if not words:
            yield f"panel {number}: the {which} axis has no name"
        elif own.get_text() and not str(own.get_gid()).startswith("unit "):
            yield f"panel {number}: {words!r} declares no unit"
        elif "(" not in words and DIMENSIONS.search(words):
            yield f"panel {number}: {words!r} has no unit"


def _series(axes: Axes, number: int) -> Iterator[str]:
    """Series without a name, and series that a grey copy cannot tell apart.

    A bare line named NAME or "NAME, ..." runs through the marks of the series NAME and needs none of its own.
    """
    looks: dict[tuple[Any, ...], set[tuple[float, ...]]] = {}
    lines = list(_capless(axes))
    marked = {_name(axes, line) for line in lines if line.get_marker() not in ("None", "", None)} - {""}
    for line in lines:
        name, drawn = _name(axes, line), line.get_linestyle() != "None"
        if not name:
            yield f"panel {number}: a line has no name"
        marks = line.get_marker() not in ("None", "", None)
        if any(name.startswith(f"{other}, ") for other in marked) or (name in marked and not marks):
            continue
        face = line.get_markerfacecolor()
        look = (
            str(line._unscaled_dash_pattern) if drawn else "", str(line.get_marker()) if marks else "",
            isinstance(face, str) and face in ("none", "white"), line.get_fillstyle(),
        )  # fmt: skip
        colour = line.get_color() if drawn else line.get_markeredgecolor()
        looks.setdefault(look, set()).add(to_rgba(colour))
    for look, colours in looks.items():
        if len(colours) > 1:
            yield f"panel {number}: {len(colours)} series differ in colour alone: {look}"


def _words(figure: Figure) -> list[Text]:
    found: list[Text] = list(figure.texts)
    for axes in (axes for axes in figure.axes if axes.get_visible()):
        found += [axes.title, axes._left_title, axes._right_title, *axes.texts]
        if axes.axison:
            for axis in (axes.xaxis, axes.yaxis):
                ticks = [one for tick in axis._update_ticks() for one in (tick.label1, tick.label2)]
                found += [axis.label, *ticks]
        legend = axes.get_legend()
        found += legend.findobj(Text) if legend is not None else []
    for legend in figure.legends:
        found += legend.findobj(Text)
    found += [t for t in (figure._supxlabel, figure._supylabel, figure._suptitle) if t is not None]
    return [t for t in dict.fromkeys(found) if t.get_visible() and t.get_text().strip()]


def _layout(figure: Figure, renderer: Any) -> Iterator[str]:
    boxes = [(words, words.get_window_extent(renderer)) for words in _words(figure)]
    boxes = [(words, box) for words, box in boxes if box.width > 1.0 and box.height > 1.0]
    width, height = figure.bbox.width, figure.bbox.height
    for words, box in boxes:
        if float(words.get_fontsize()) not in SIZES or words.get_fontname() != STYLE["font.family"]:
            yield f"{words.get_text()!r} has {words.get_fontsize()} pt {words.get_fontname()}"
        if box.x0 < -0.5 or box.y0 < -0.5 or box.x1 > width + 0.5 or box.y1 > height + 0.5:
            yield f"{words.get_text()!r} is cut"
    for (words, a), (others, b) in itertools.combinations(boxes, 2):
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1.0 and min(a.y1, b.y1) - max(a.y0, b.y0) > 1.0:
            yield f"{words.get_text()!r} overlaps {others.get_text()!r}"


def _legends(axes: Axes, number: int, renderer: Any) -> Iterator[str]:
    legend = axes.get_legend()
    if legend is None:
        return
    box = legend.get_window_extent(renderer)
    for line in _capless(axes):
        places = axes.transData.transform(np.array(line.get_xydata(), dtype=float))
        if any(box.contains(x, y) and axes.bbox.contains(x, y) for x, y in places if np.isfinite(x + y)):
            yield f"panel {number}: the legend covers points of {_name(axes, line)!r}"


def complaints(figure: Figure) -> list[str]:
    """What a referee would object to."""
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    shown = [axes for axes in figure.axes if axes.get_visible() and axes.get_label() != "<colorbar>"]
    found = [
        words
        for number, axes in enumerate(shown) if axes.axison
        for words in (*_quantities(axes, number), *_series(axes, number), *_legends(axes, number, renderer))
    ]  # fmt: skip
    letters = [re.match(r"\((\w)\)", axes.get_title(loc="left")) for axes in shown if not axes.get_label()]
    if len(letters) > 1:
        if not all(letters):
            found.append("a panel has no letter")
        elif sorted(m.group(1) for m in letters if m) != [chr(ord("a") + i) for i in range(len(letters))]:
            found.append("the letters of the panels have gaps")
    return found + list(_layout(figure, renderer))


# made-up rows


def _transitions() -> Figure:
    excess = np.linspace(-1e-3, 1e-3, 9)
    fives = np.where(excess[:, None] > 0, 1e-3 * np.arange(5), 0.0)
    whole = np.zeros(9, dtype=int)
    found = OrbitDiagram(
        excess=excess, points=fives, period=np.where(excess > -9e-4, 5, 0), impacts=whole, cycles=whole,
        failures=(), end=None,
    )
    rows = [
        {"frequency_hz": f, "letter": m, "map": m, "single_mode": m, "beam": m, "grazing_amplitude_m": 2e-3}
        for f, m in PERIODS.items()
    ]
    ways = {name: {"up": found, "down": found} for name in ("map", "single_mode", "beam")}
    return transition_figures.draw(read_scene("letter"), rows, [ways] * len(rows), "beam")


def _trace() -> Figure:
    time = np.linspace(0.0, 0.37, 400)
    tip = 0.01 * np.sin(140.0 * time)
    trace = Trace(
        period=4, time=time, tip=tip, readout=0.9 * tip, impact_times=np.array([0.1, 0.3]), collisions=[]
    )
    near = CloseUp(time=1e-4 * time, height=1e-4 * tip, force=np.abs(tip), spans=[(0.0, 3e-5)])
    title = "p$_4$, 21.50 Hz, $F/F_g - 1$ = 0.013 (letter: p$_4$)"
    return trace_figure.draw_trace(trace, near, 0.0107, "mm", title)


def _spectrum() -> Figure:
    f = np.arange(5.0, 3000.0, 5.0)
    modes = np.array([24.5, 149.0, 378.0, 718.0, 1170.0])
    return trace_figure.draw_spectrum(f, 1.0 / f**2, modes, 21.5, "mm")


def _folds() -> list[dict[str, Any]]:
    names = ("map", "map_measured_kick", "single_mode", "two_parameters", "all_mode_kick", "beam")
    return [
        {"frequency_hz": f, "m": m, "causes": dict.fromkeys(CAUSES, 0.3 if m < 8 else None)}
        | {name: -1e-3 * (i + 1) * (24.0 - f) for i, name in enumerate(names)}
        for m, f in ((m, f) for f, m in PERIODS.items())
    ]


def _soft_rows() -> list[dict[str, Any]]:
    return [
        {
            "frequency_hz": f, "K": K, "case": case, "period": m, "hysteresis": -1e-3 / K**0.3,
            "hysteresis_hard": -1e-2, "hysteresis_shift": 1e-2 / K**0.4, "excess_pd_measured": f / K**2,
            "excess_pd_leading": 1.1 * f / K**2, "excess_pd_theory": 1.01 * f / K**2,
        }
        for f, m in PERIODS.items() for K in (1e2, 1e4, 1e6) for case in ("lossless", "dashpot")
    ]  # fmt: skip


def _kicks() -> Figure:
    excess = np.geomspace(1e-8, 1e-2, 7)
    return soft_wall.draw_kicks(
        [
            {"K": K, "case": case, "excess": excess, "soft_law": K * excess**1.5, "hard_law": excess**0.5,
             "kick_velocity": 0.9 * excess**0.5 / K**0.1, "closed_form": 0.9 * excess**0.5 / K**0.1}
            for K in (1e1, 1e3, 1e5) for case in ("lossless", "dashpot")
        ],
        2.5e-4,
    )  # fmt: skip


def _doubling() -> Figure:
    K = np.geomspace(1e1, 1e6, 20)
    lines = [{"frequency_hz": f, "K": K, "leading": f / K**2, "closed_form": 1.1 * f / K**2} for f in PERIODS]
    return soft_wall.draw_doubling(_soft_rows(), lines, 2.5e-4)


def _soft_beam() -> Figure:
    excess = np.geomspace(1e-7, 1e-1, 13)
    born = [{"excess": e, "period_gently": 1 if e < 3e-6 else 5, "period_in_one_step": 5} for e in excess]
    beam = {
        "excess": excess, "kick_velocity": excess**0.5, "slope": 0.5 + 1.5 / (1.0 + excess / 1e-5),
        "soft_law": 1e6 * excess**2, "hard_law": excess**0.5, "born": born, "half_excess": 7e-5,
        "doubling_excess": 3e-6,
    }  # fmt: skip
    return soft_wall.draw_beam(beam, 2.5e-4)


def _tornado() -> Figure:
    common = {"frequency_hz": 20.9, "m": 3, "born_beam": 3}
    rows = [common | {"parameter": "none", "sign": 0, "fold_beam": -1e-3, "fold_single_mode": -2e-3}]
    for parameter, sign in itertools.product(("free period", "restitution of Eq. (1)", "gap"), (-1, 1)):
        fold = None if (parameter, sign) == ("gap", 1) else -1e-3 * (1.0 + 0.3 * sign)
        folds = {"fold_beam": fold, "fold_single_mode": -3e-3}
        rows.append(common | folds | {"parameter": parameter, "sign": sign})
    return draw_tornado([row | {"frequency_hz": f} for f in PERIODS for row in rows])


def _noise() -> Figure:
    def cloud(m: int) -> dict[str, float]:
        return {"told_apart": 100.0 / m**2, "regular": 1.0}

    rows = [
        {"m": m, "jitter": cloud(m), "drift": cloud(m + 2), "fold": -0.1 / m**3, "upper_end": 1.0 / m**2}
        for m in range(3, 17)
    ]
    return draw_noise(rows)


def _costs() -> Figure:
    cases = ("beam, hertz contact", "beam, linear contact", "beam, hertz contact, no touch")
    tools = (("grazing-spring", 1.0), ("floor", 0.01), ("heyoka", 30.0))
    return draw_costs([
        {"case": case, "tool": tool, "modes": n, "us_per_period": cost * (i + 1) * n**0.5}
        for i, case in enumerate(cases) for tool, cost in tools for n in (1, 4, 20)
    ])  # fmt: skip


def _speed() -> Figure:
    rows = [
        {"curve": "speed", "series": name, "value": v, "restitution": 0.2, "delay_s": 1e-4, "kick": kick,
         "contact_s": 1e-4, "arc_s": 1e-3, "failure": "", "impacts": 1, "ball_limit": 1.0}
        for name, kick in (("scene", 0.9), ("hertz", 0.9), ("bare tip", 0.5)) for v in (1e-5, 1e-3, 1e-1)
    ]  # fmt: skip
    return speed(rows)


DRAWN: dict[str, Callable[[], Figure]] = {
    "transitions": _transitions,
    "trace": _trace,
    "spectrum": _spectrum,
    "hysteresis": lambda: hysteresis_figures.draw_curves(read_scene("letter"), _folds()),
    "ratios": lambda: hysteresis_figures.draw_ratios(read_scene("letter"), _folds()),
    "causes": lambda: hysteresis_figures.draw_causes(_folds()),
    "kicks": _kicks,
    "doubling": _doubling,
    "soft hysteresis": lambda: soft_wall.draw_hysteresis(_soft_rows()),
    "soft beam": _soft_beam,
    "tornado": _tornado,
    "noise": _noise,
    "costs": _costs,
    "speed": _speed,
}


@functools.cache
def figure_of(name: str) -> Figure:
    """The figure of that name, drawn once."""
    return DRAWN[name]()


@pytest.mark.parametrize("name", DRAWN)
def test_a_referee_has_nothing_to_say(name: str) -> None:
    """Names and units on axes, series told apart in grey, letters of panels, no words cut or overlapping."""
    assert complaints(figure_of(name)) == []


@pytest.mark.parametrize("name", DRAWN)
def test_the_table_beside_a_figure_holds_what_is_drawn(name: str) -> None:
    """Every finite point of every line is in the table, under a name and with quantities on both axes."""
    figure = figure_of(name)
    table = drawn_points(figure)
    rows = list(zip(*table.values(), strict=True))
    assert rows and "" not in table["series"]
    assert all(table["x_quantity"]) and all(table["y_quantity"])
    drawn = {(row["series"], row["x"], row["y"]) for row in (dict(zip(table, r, strict=True)) for r in rows)}
    for axes in figure.axes:
        for line in _capless(axes):
            for x, y in np.asarray(line.get_xydata(), dtype=float):
                if np.isfinite(x + y):
                    assert (_name(axes, line), f"{x:.8g}", f"{y:.8g}") in drawn
    assert sum(len(str(cell)) + 1 for row in rows for cell in row) < LARGEST_FILE


def test_the_values_of_the_letter_are_marked() -> None:
    """Frequencies, periods, stability of the amplitude and restitution, where they are on an axis."""
    titles = " ".join(axes.get_title("left") for axes in _transitions().axes)
    assert re.findall(r"letter: p\$_\{(\d+)", titles) == [str(m) for m in PERIODS.values()]
    for draw, which, value in (
        (DRAWN["hysteresis"], "y", 2.5e-4), (_kicks, "x", 2.5e-4), (_doubling, "y", 2.5e-4),
        (_noise, "x", 10.0), (_noise, "y", 2.5e-4), (_speed, "y", 0.1),
    ):  # fmt: skip
        table = drawn_points(draw())
        marked = [table[which][i] for i, name in enumerate(table["series"]) if name.startswith("letter")]
        assert f"{value:.8g}" in marked


# planted faults


def _sound() -> tuple[Figure, Axes]:
    @in_house_style
    def draw() -> tuple[Figure, Axes]:
        figure, axes = new_figure()
        axes.plot([0.0, 1.0], [0.0, 1.0], **series(0), label="up")
        axes.plot([0.0, 1.0], [1.0, 0.0], **points(1), label="down")
        label(axes.xaxis, "time", "ms")
        label(axes.yaxis, "kick")
        mark_letter(axes.yaxis, 0.3, 0.05)
        return figure, axes

    return draw()


FAULTS: dict[str, tuple[Callable[[Figure, Axes], Any], str]] = {
    "no name": (lambda f, a: a.plot([0.2], [0.2], **points(4)), "has no name"),
    "colour alone": (
        lambda f, a: a.plot([0.0, 1.0], [0.5, 0.6], **{**series(0), "color": PALETTE[3]}, label="x"),
        "colour alone",
    ),
    "no unit": (lambda f, a: label(a.xaxis, "time"), "has no unit"),
    "bare label": (lambda f, a: a.yaxis.label.set_gid(None), "declares no unit"),
    "no axis": (lambda f, a: a.set_xlabel(""), "x axis has no name"),
    "cut": (lambda f, a: f.text(0.9, 0.5, "words that go on", fontsize=7.0), "cut"),
    "overlap": (lambda f, a: [a.text(0.4, 0.5, "words", fontsize=7.0) for _ in range(2)], "overlaps"),
    "size": (lambda f, a: a.text(0.4, 0.5, "words", fontsize=5.0), "5.0 pt"),
    "legend": (lambda f, a: a.legend(loc="lower left"), "legend covers"),
}


def test_a_sound_figure_passes() -> None:
    assert complaints(_sound()[0]) == []


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str) -> None:
    figure, axes = _sound()
    plant, words = FAULTS[fault]
    plant(figure, axes)
    assert any(words in told for told in complaints(figure)), complaints(figure)


@in_house_style
def test_panels_need_letters() -> None:
    figure, axes = new_figure(1, 2, width=0.178)
    for axis in axes:
        axis.plot([0.0, 1.0], [0.0, 1.0], label="up")
        label(axis.xaxis, "m")
        label(axis.yaxis, "kick")
    panel(axes[0], 0)
    assert "a panel has no letter" in complaints(figure)
    panel(axes[1], 2)
    assert "the letters of the panels have gaps" in complaints(figure)
    panel(axes[1], 1)
    assert complaints(figure) == []


# what stands beside a figure


def test_bars_errors_guides_and_maps_are_read_back() -> None:
    figure, (left, middle, right) = new_figure(1, 3, width=0.178)
    left.bar([1.0, 2.0], [0.5, -0.5], 0.4, bottom=1.0, label="bars")
    left.axhline(0.25, **GUIDE, gid="zero")
    middle.errorbar([1.0, 2.0], [3.0, 4.0], yerr=[0.1, 0.2], capsize=2.0, label="mean")
    middle.plot([5.0, 5.0, np.nan], [6.0, 6.0, 1.0], **LETTER_POINTS, gid="letter")
    middle.axvspan(1.2, 1.4, gid="span")
    x, y = np.geomspace(1.0, 1000.0, 4), np.array([0.0, 1.0, 3.0])
    values = np.arange(12.0).reshape(3, 4)
    right.pcolormesh(x, y, values, shading="nearest", gid="cells")
    for axis, across in ((left, "case"), (middle, "m"), (right, "K")):
        label(axis.xaxis, across)
        label(axis.yaxis, "delay", "ms")
    table = drawn_points(figure)
    rows = [{k: v for k, v in zip(table, row, strict=True) if v != ""}
            for row in zip(*table.values(), strict=True)]  # fmt: skip
    short = [{k: v for k, v in row.items() if "quantity" not in k} for row in rows]
    assert short[:3] == [
        {"panel": "a", "series": "bars", "x": "1", "y": "1.5", "low": "1", "high": "1.5"},
        {"panel": "a", "series": "bars", "x": "2", "y": "0.5", "low": "0.5", "high": "1"},
        {"panel": "a", "series": "zero", "y": "0.25"},
    ]
    assert short[3:] == [
        {"panel": "b", "series": "mean", "x": "1", "y": "3", "low": "2.9", "high": "3.1"},
        {"panel": "b", "series": "mean", "x": "2", "y": "4", "low": "3.8", "high": "4.2"},
        {"panel": "b", "series": "letter", "x": "5", "y": "6"},
        {"panel": "b", "series": "span", "x": "1.2"},
        {"panel": "b", "series": "span", "x": "1.4"},
    ]
    assert rows[0]["x_quantity"] == "case" and rows[0]["y_quantity"] == "delay (ms)"
    (found,) = drawn_maps(figure).values()
    heading, *columns = found
    assert heading == "delay (ms); across: K; cells: cells" and list(found[heading]) == ["0", "1", "3"]
    assert [float(place) for place in columns] == pytest.approx(x)
    assert np.array([[float(v) for v in found[c]] for c in columns]).T == pytest.approx(values)


def test_an_image_is_read_at_its_pixels() -> None:
    figure, axes = new_figure()
    axes.imshow([[1.0, 2.0], [3.0, np.nan]], origin="lower", extent=(0.0, 4.0, 0.0, 2.0))
    (found,) = drawn_maps(figure).values()
    assert list(found.values()) == [["0.5", "1.5"], ["1", "3"], ["2", ""]] and list(found)[1:] == ["1", "3"]


def test_a_record_writes_picture_vector_form_and_points(tmp_path: Path) -> None:
    """Whatever a study draws goes through this one door."""
    record = Record(study="s", folder=tmp_path, scene=read_scene("letter"), command="")
    figure, axes = _sound()
    axes.pcolormesh(np.arange(2.0), np.arange(2.0), np.eye(2), shading="nearest", gid="cells", alpha=0.1)
    record.write_figure(figure, "curve")
    assert record.files == ["curve.png", "curve.pdf", "curve_drawn.csv", "curve_drawn_map.csv"]
    with (tmp_path / "curve_drawn.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    up = [(float(row["x"]), float(row["y"])) for row in rows if row["series"] == "up"]
    assert up == [(0.0, 0.0), (1.0, 1.0)] and rows[0]["x_quantity"] == "time (ms)"
    band = [float(row["y"]) for row in rows if row["series"] == "letter, error"]
    assert band == pytest.approx([0.25, 0.35])


# one style


def _drawing_files() -> list[Path]:
    folder = ROOT / "studies"
    return [
        path for path in sorted(folder.rglob("*.py"))
        if "studies.instruments.figures import" in path.read_text() and path.name not in OUTSIDE
        and path.parent.name not in OUTSIDE
    ]  # fmt: skip


OUTSIDE = ("chart", "modes", "motion", "report", "mode_figures.py", "record.py")
"""Pictures of shapes, films, the chart and the report have colours and sizes of their own."""


def test_no_drawing_file_leaves_the_house_style() -> None:
    """No colour by its digits, no size of letters, no size of a figure and no pyplot of a file's own."""
    files = _drawing_files()
    assert len(files) > 25
    literal = re.compile(
        r"fontsize=[\d.]|figsize|pyplot|rcParams|set_xlabel|set_ylabel|[\"']#[0-9A-Fa-f]{6}"
    )
    found = {
        f"{path.name}: {match}"
        for path in files
        for match in literal.findall(path.read_text())
    }  # fmt: skip
    assert found == {'figures.py: "#D8B24A'}  # the brass of the drawn springs


def test_what_makes_a_figure_is_in_house_style() -> None:
    """Each function that makes a figure is decorated, or makes it within `house_style`."""
    bare = []
    for path in _drawing_files():
        for node in ast.walk(ast.parse(path.read_text())):
            if not isinstance(node, ast.FunctionDef):
                continue
            source = ast.unparse(node)
            styled = any("in_house_style" in ast.unparse(one) for one in node.decorator_list)
            if "new_figure(" in source and not styled and "house_style()" not in source:
                bare.append(f"{path.name}: {node.name}")
    assert bare == ["panels.py: three"]  # called by the decorated functions of its own figures.py
