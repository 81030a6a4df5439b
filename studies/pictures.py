"""The two pictures of the README: an orbit diagram, and error against cost.

p4.png shows the spring of the letter's scene at an impact of p4, relative to its base and in true scale.
Beside it stands the orbit diagram around p4.  costs.png shows the error of each method against its time for a
drive period.  Its numbers are in docs/costs.csv; `work_precision` measures them, for Hertz's contact.  Each
file carries what it shows as JSON, in a text of the PNG file with the name "drawn".

Run:     python -m studies pictures [--out DIR]
Writes:  p4.png, costs.png; by default in docs/pictures of the checkout
"""

import csv
import io
import json
from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from contact import StroboscopicMap, simulate
from contact.orbits import Shooting, fold_of
from studies import ROOT, letter
from studies.physics.descriptions import up_and_down
from studies.shell.files import json_text, make_folder, write_atomically
from studies.shell.options import Parser, tool
from studies.shell.painter import draw_rig
from studies.shell.plotting import BLUE, PALETTE, PURPLE, STYLE, VERMILION, Style
from studies.shell.scene import beam_at, model_of, modes_of, read_scene

Drawn = Mapping[str, Any]  # what a picture shows: names -> numbers, rows of numbers, or mappings of them

SCENE = read_scene("letter", ["modes.count=12"])
COSTS, PICTURES = ROOT / "docs" / "costs.csv", ROOT / "docs" / "pictures"
EXCESSES = np.linspace(-1.495, 1.205, 46)
"""Excesses in the diagram, in units of the hysteresis; none lies on the fold or on grazing."""

LARGE = STYLE | {"font.size": 13.0, "axes.labelsize": 13.0, "xtick.labelsize": 11.0, "ytick.labelsize": 11.0}


def orbit_drawn() -> Drawn:
    """Base amplitudes and displacements at the strobes [mm], and modal coordinates of the p4 orbit [m]."""
    oscillator = beam_at(SCENE, letter.TIME_TRACE_HZ, model_of(SCENE))
    strobed, grazing = StroboscopicMap(oscillator=oscillator), 1e3 * oscillator.grazing_amplitude()
    fold = fold_of(Shooting(oscillator=oscillator, m=4))
    assert fold is not None
    settle: dict[str, Any] = {"settle_cycles": 1000, "record_cycles": 4, "observe": strobed.tip}
    scans = up_and_down(strobed, -fold.excess * EXCESSES, **settle)
    here = strobed.at(letter.TIME_TRACE_EXCESS)
    end = here.orbit(scans["up"].end, 1000).end
    times = end.time + here.period * np.linspace(0.0, 4.0, 2001)
    motion = simulate(here.oscillator, end, periods=5, times=times)
    hit = simulate(here.oscillator, end, periods=5, times=motion.impacts.start[:1])
    ways = {"raised": scans["up"], "lowered": scans["down"]}
    return {
        "grazing": grazing,
        "fold": grazing * (1.0 + fold.excess),
        "amplitudes": {way: grazing * (1.0 + scan.excess) for way, scan in ways.items()},
        "strobes": {way: 1e3 * np.sort(scan.points) for way, scan in ways.items()},
        "impact": hit.displacement[0],
        "lowest": motion.displacement[np.argmin(strobed.oscillator.tip(motion.displacement))],
    }


def costs_drawn() -> Drawn:
    """The rows of the table of costs by method; None where a cell is empty."""
    with COSTS.open(newline="", encoding="utf-8") as stream:
        rows = [(row.pop("method"), row) for row in csv.DictReader(stream)]
    return {name: {key: float(cell) if cell else None for key, cell in row.items()} for name, row in rows}


def draw_orbit(drawn: Drawn) -> Figure:
    """The spring at an impact; displacement at the strobes: dots while raised, rings while lowered."""
    figure = Figure(figsize=(12.0, 4.5))
    shapes = [drawn["impact"], drawn["lowest"], np.zeros(len(drawn["impact"]))]
    axes = figure.add_axes((0.005, 0.06, 4.55 / 12.0, 3.5 / 4.5))
    draw_rig(axes, SCENE, modes_of(SCENE), shapes, ("", "lowest", "at rest"))
    figure.text(0.012, 0.93, "the spring at an impact of p4, in true scale")
    axes = figure.add_axes((0.51, 0.145, 0.48, 0.835))
    for way, colour, face, size in (("lowered", VERMILION, "none", 6.5), ("raised", BLUE, BLUE, 3.2)):
        look: Style = {"color": colour, "markerfacecolor": face, "markersize": size}
        axes.plot(drawn["amplitudes"][way], np.array(drawn["strobes"][way]), "o", **look)
    fold, grazing, raised = drawn["fold"], drawn["grazing"], drawn["amplitudes"]["raised"]
    axes.axvline(fold, color="0.4", linestyle=":", linewidth=1.2, zorder=0)
    axes.axvline(grazing, color="0.4", linestyle="--", linewidth=1.2, zorder=0)
    axes.annotate("", (fold, 1.6), (grazing, 1.6), arrowprops={"arrowstyle": "->", "color": PURPLE})
    middle = 0.5 * (fold + grazing)
    for words, x, y, colour, side in (
        ("fold ", fold, 2.0, "0.3", "right"),
        (" grazing", grazing, 2.0, "0.3", "left"),
        ("hysteresis", middle, 2.0, PURPLE, "center"),
        ("drive raised", middle, -0.7, BLUE, "center"),
        ("drive lowered", middle, 0.95, VERMILION, "center"),
        ("p1", raised[3], -0.7, "black", "center"),
        ("p4: one impact\nin four drive periods", raised[-1], 0.2, "black", "right"),
    ):
        axes.text(x, y, words, color=colour, ha=side, va="center")
    axes.set(xlabel="drive amplitude F (mm)", ylabel="displacement at each strobe (mm)", ylim=(-3.8, 2.3))
    return figure


def draw_costs(drawn: Drawn) -> Figure:
    """Each method from its cost at an error of 1e-4 to its cost at 1e-8; exact flights as one point."""
    figure = Figure(figsize=(7.5, 4.5))
    axes = figure.add_axes((0.13, 0.135, 0.85, 0.845))
    ordered = sorted(drawn.items(), key=lambda item: item[1]["microseconds_at_1e-8"])
    lines = [name for name, row in ordered if row["error"] is None]
    for name, row in ordered:
        start, end = (1e-6 * row[f"microseconds_at_1e-{n}"] for n in (4, 8))
        missed = f", {100.0 * row['missed_at_1e-8']:.0f} % missed" if row["missed_at_1e-8"] else ""
        if row["error"] is not None:
            star = not missed
            axes.loglog(end, row["error"], "*k" if star else "ok", markersize=16.0 if star else 5.0)
            look: Style = {"textcoords": "offset points", "va": "center", "ha": "right" if star else "left"}
            axes.annotate(name + missed, (end, row["error"]), (-12 if star else 10, 0), **look)
            continue
        place = lines.index(name)
        axes.loglog([start, end], [1e-4, 1e-8], "o-", color=PALETTE[place], linewidth=2.0, markersize=5.0)
        line: Style = {"arrowstyle": "-", "linestyle": ":", "color": PALETTE[place], "relpos": (1.0, 0.5)}
        line |= {"shrinkA": 0.0}
        below = end, 1e-8 * 10.0 ** (-1.0 - 1.1 * place)  # the further right, the lower: no line meets a word
        look = {"ha": "right", "va": "center", "arrowprops": line, "color": PALETTE[place]}
        axes.annotate(f"{name}{missed} ", (end, 1e-8), below, **look)
    words = "missed: share of shallow touches, at the lower end of a line; else none"
    axes.text(0.99, 0.02, words, transform=axes.transAxes, ha="right", color="0.4", fontsize=11.0)
    axes.set(
        xlabel="time to compute a drive period",
        ylabel="error after the first collision",
        xlim=(1e-6, 0.5),
        ylim=(3e-18, 1e-3),
    )
    axes.xaxis.set_major_formatter(EngFormatter(unit="s"))
    axes.minorticks_off()
    return figure


def png_of(draw: Callable[[Drawn], Figure], drawn: Drawn) -> bytes:
    """The picture in 128 colours, and what it shows in six digits."""
    stream, packed, words = io.BytesIO(), io.BytesIO(), PngInfo()
    with matplotlib.rc_context(LARGE):
        draw(drawn).savefig(stream, format="png", dpi=140)
    numbers = json.loads(json_text(drawn), parse_float=lambda digits: float(f"{float(digits):.6g}"))
    words.add_text("drawn", json.dumps(numbers), zip=True)
    image = Image.open(stream).convert("RGB").quantize(128, dither=Image.Dither.NONE)
    image.save(packed, format="PNG", optimize=True, pnginfo=words)
    return packed.getvalue()


def pictures(given: Namespace) -> tuple[str, Mapping[str, object]]:
    """Draw both pictures, and write them when both are drawn."""
    folder, costs = make_folder(given.out), png_of(draw_costs, costs_drawn())
    drawn = {"p4.png": png_of(draw_orbit, orbit_drawn()), "costs.png": costs}
    paths = [write_atomically(folder / name, content) for name, content in drawn.items()]
    return f"drawn: {' and '.join(map(str, paths))}", {"pictures": paths}


def main(argv: Sequence[str] | None = None) -> int:
    """Draw the pictures; returns 0, or 2 for wrong use."""
    parser = Parser("python -m studies pictures", __doc__ or "")
    parser.add_argument("--out", type=Path, default=PICTURES, metavar="DIR", help="folder of the pictures")
    return tool(parser, argv, pictures)
