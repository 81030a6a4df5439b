"""The two pictures of the README: period four at a plate, and error against cost.

p4.png shows the spring of the letter's scene at an impact of p4, in true scale, and the orbit diagram around
it.  costs.png shows the time that each method takes for a drive period, against its error, from docs/costs.csv.
Each picture carries what it shows as JSON, in a text of the PNG file with the name "drawn".

Run:     python -m studies pictures [--out DIR]
Writes:  p4.png, costs.png; by default in docs/pictures of the checkout
"""

from __future__ import annotations

import csv
import io
import json
from argparse import Namespace
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from beam import BALL, InvalidValue
from contact import StroboscopicMap, simulate
from contact.orbits import Shooting, fold_of
from studies import ROOT, letter
from studies.experiment.time_trace.film import drawn_shapes
from studies.physics.descriptions import up_and_down
from studies.shell.film import DRIVE, NO_RENDERING, TOUCHED, Scenery, can_render, prepare_off_screen
from studies.shell.files import json_text, make_folder, write_atomically
from studies.shell.options import Parser, tool
from studies.shell.plotting import BLACK, BLUE, PALETTE, PURPLE, STYLE, VERMILION
from studies.shell.scene import beam_at, model_of, modes_of, read_scene

Drawn = Mapping[str, Any]
"""What a picture shows: names -> numbers, rows of numbers and words."""

COSTS = ROOT / "docs" / "costs.csv"
"""Method; microseconds for a drive period and share of touches missed at both errors; own error of exact."""

PERIOD, MODES, CYCLES = 4, 12, 1000
"""Period of the orbit; modes that its fold needs; bound of the drive periods to settle at an amplitude."""

EXCESSES = np.linspace(-1.495, 1.205, 46)
"""Amplitudes of the diagram, as parts of the hysteresis above grazing; none lies on grazing or fold."""

DOTS_PER_INCH, COLOURS_KEPT, LARGEST = 140, 128, 60_000
"""Dots per inch of a picture, colours of its palette, and the bytes that it may have."""

LARGE = STYLE | {"font.size": 13.0, "axes.labelsize": 13.0, "xtick.labelsize": 11.0, "ytick.labelsize": 11.0}
"""The house style, in the sizes of a picture as wide as a screen."""

DOT = {"color": BLUE, "markersize": 3.2}
RING = {"color": VERMILION, "markerfacecolor": "none", "markersize": 6.5}

TOWARDS_VIEWER = np.array([-0.55, 0.42, 0.72])
"""From the spring to the viewer."""
WORDS = {
    "plate": ((-16.0, 4.0), "#D9600B", ("right", "bottom")),
    "ball": ((-52.0, 8.0), "#5A6470", ("right", "center")),
    "base": ((0.0, -34.0), "#4A4A4A", ("center", "top")),
    "lowest": ((5.0, 0.0), "#A08738", ("left", "center")),
    "at rest": ((5.0, 0.0), "#A08738", ("left", "center")),
}
"""Names in the view of the spring: offset from the place [pt], colour, sides."""

STRIP_COLOUR, BALL_COLOUR, BASE_COLOUR = "#D0A62B", "#5A6470", "#4A4A4A"


def orbit_drawn() -> Drawn:
    """Displacements at the strobes and base amplitudes [mm], and the modal coordinates at an impact [m]."""
    scene = read_scene("letter", [f"modes.count={MODES}"])
    oscillator = beam_at(scene, letter.TIME_TRACE_HZ, model_of(scene))
    fold = fold_of(Shooting(oscillator=oscillator, period=PERIOD))
    if fold is None:
        raise InvalidValue(f"the scene has no fold of p{PERIOD} at {letter.TIME_TRACE_HZ:g} Hz")
    strobed, grazing = StroboscopicMap(oscillator=oscillator), 1e3 * oscillator.grazing_amplitude()
    scans = up_and_down(
        strobed, -fold.excess * EXCESSES, observe=strobed.tip, settle_cycles=CYCLES, record_cycles=PERIOD
    )
    here = strobed.at(letter.TIME_TRACE_EXCESS)
    end = here.orbit(scans["up"].end, CYCLES).end
    times = end.time + np.linspace(0.0, PERIOD, 2001) * here.period
    motion = simulate(here.oscillator, end, periods=PERIOD + 1, times=times)
    lowest = motion.displacement[np.argmin(here.oscillator.tip(motion.displacement))]
    first = motion.impacts.start[:1]
    (struck,) = simulate(here.oscillator, end, periods=PERIOD + 1, times=first).displacement
    ways = {"raised": scans["up"], "lowered": scans["down"]}
    return {
        "frequency_hz": letter.TIME_TRACE_HZ,
        "excess": letter.TIME_TRACE_EXCESS,
        "grazing_mm": grazing,
        "fold_mm": grazing * (1.0 + fold.excess),
        "amplitude_mm": {way: grazing * (1.0 + scan.excess) for way, scan in ways.items()},
        "strobes_mm": {way: 1e3 * np.sort(scan.points) for way, scan in ways.items()},
        "at_impact_m": struck,
        "at_lowest_m": lowest,
    }


def costs_drawn() -> Drawn:
    """The rows of the table of costs, by method; None where a cell is empty."""
    with COSTS.open(newline="", encoding="utf-8") as stream:
        rows = [(row.pop("method"), row) for row in csv.DictReader(stream)]
    return {name: {key: float(cell) if cell else None for key, cell in row.items()} for name, row in rows}


def spring_seen(drawn: Drawn, size: tuple[int, int]) -> tuple[Any, dict[str, tuple[float, float]]]:
    """The spring in `size` pixels, in true scale, and where the words belong in it [pixels]."""
    prepare_off_screen()
    import pyvista

    scene = read_scene("letter", [f"modes.count={MODES}"])
    modes, gap = modes_of(scene), scene.stop.gap_m
    scenery = Scenery.of(modes, ball_radius=scene.tip.ball_radius_m, gap=gap, swing=gap)
    mesh, plate = scenery.mesh, scenery.plate
    coordinates = np.array([drawn["at_impact_m"], drawn["at_lowest_m"], [0.0] * MODES])
    shapes = mesh.points + drawn_shapes(mesh, modes, coordinates, 1.0)[0]
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(size))
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    for points, opacity in zip(shapes, (1.0, 0.16, 0.10), strict=True):
        strip, ball = mesh.grid(points), np.unique(mesh.triangles)
        is_ball = strip.cell_data["part"] == BALL
        look = {"opacity": opacity, "ambient": 0.35, "diffuse": 0.65}
        plotter.add_mesh(strip.extract_cells(~is_ball), color=STRIP_COLOUR, **look)
        plotter.add_mesh(strip.extract_cells(is_ball), color=BALL_COLOUR, smooth_shading=True, **look)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    base = np.array([(-0.012, -0.008, low[2] - 0.004), (0.002, 0.008, high[2] + 0.004)])
    for box, colour in ((plate, TOUCHED), (base, BASE_COLOUR)):
        plotter.add_mesh(pyvista.Box(box.T.ravel()), color=colour, ambient=0.35, diffuse=0.65)
    cloud = np.concatenate([*shapes, plate, base])
    towards = TOWARDS_VIEWER / np.linalg.norm(TOWARDS_VIEWER)
    right = np.cross(DRIVE, towards) / np.linalg.norm(np.cross(DRIVE, towards))
    across = np.array([right, np.cross(towards, right)])
    seen = cloud @ across.T
    middle, extent = 0.5 * (seen.min(axis=0) + seen.max(axis=0)), np.ptp(seen, axis=0)
    scale = 0.53 * max(extent[1], extent[0] * size[1] / size[0])
    camera, centre = plotter.camera, middle @ across
    camera.position, camera.focal_point, camera.up = tuple(centre + towards), tuple(centre), tuple(DRIVE)
    camera.parallel_projection, camera.parallel_scale = True, scale
    image = plotter.screenshot(return_img=True)
    plotter.close()

    def place(point: Any) -> tuple[float, float]:
        x, y = (across @ point - middle) * 0.5 * size[1] / scale
        return 0.5 * size[0] + x, 0.5 * size[1] - y

    return image, {
        "plate": place(plate.mean(axis=0)),
        "ball": place(shapes[0][ball].mean(axis=0)),
        "base": place(base.mean(axis=0)),
        "lowest": place(shapes[1][np.argmax(shapes[1] @ right)]),
        "at rest": place(shapes[2][np.argmax(shapes[2] @ right)]),
    }


def draw_orbit(drawn: Drawn) -> Figure:
    """The spring at an impact, and the orbit diagram."""
    figure = figure_of(12.0, 4.5)
    left = figure.add_axes((0.005, 0.09, 4.55 / 12.0, 3.5 / 4.5))
    image, places = spring_seen(drawn, (1274, 980))
    left.imshow(image)
    left.axis("off")
    for name, (offset, colour, sides) in WORDS.items():
        line = {"arrowstyle": "-", "color": colour} if name == "ball" else None
        place = {"xytext": offset, "textcoords": "offset points", "ha": sides[0], "va": sides[1]}
        left.annotate(name, places[name], color=colour, arrowprops=line, annotation_clip=False, **place)
    figure.text(0.012, 0.93, f"the spring at an impact of p{PERIOD}, in true scale")
    orbit_diagram(figure.add_axes((0.51, 0.145, 0.48, 0.835)), drawn)
    return figure


def orbit_diagram(axes: Axes, drawn: Drawn) -> None:
    """Displacement at the strobes against the amplitude: dots while it is raised, rings while lowered."""
    for way, look in (("lowered", RING), ("raised", DOT)):
        amplitude, strobes = (np.array(drawn[name][way]) for name in ("amplitude_mm", "strobes_mm"))
        axes.plot(amplitude, strobes, linestyle="none", marker="o", **look)
    fold, grazing, top = drawn["fold_mm"], drawn["grazing_mm"], 2.0
    for value, name, line, side in ((fold, "fold ", ":", "right"), (grazing, " grazing", "--", "left")):
        axes.axvline(value, color="0.4", linestyle=line, linewidth=1.2, zorder=0)
        axes.text(value, top, name, color="0.3", ha=side, va="center")
    axes.annotate("", (fold, 1.6), (grazing, 1.6), arrowprops={"arrowstyle": "->", "color": PURPLE})
    middle, last = 0.5 * (fold + grazing), drawn["amplitude_mm"]["raised"][-1]
    axes.text(middle, top, "hysteresis", color=PURPLE, ha="center", va="center")
    axes.text(middle, -0.75, "raised", color=BLUE, ha="center", va="center")
    axes.text(middle, 0.95, "lowered", color=VERMILION, ha="center", va="center")
    axes.text(drawn["amplitude_mm"]["raised"][3], -0.75, "p1", ha="center", va="center")
    axes.text(last, 0.2, f"p{PERIOD}: one impact\nin four drive periods", ha="right", va="center")
    axes.set(xlabel="amplitude of the base (mm)", ylabel="displacement at each strobe (mm)", ylim=(-3.8, 2.3))


def draw_costs(drawn: Drawn) -> Figure:
    """Each method from its cost at an error of 1e-4 to its cost at 1e-8; the exact method as a star."""
    figure = figure_of(7.5, 4.5)
    axes = figure.add_axes((0.13, 0.135, 0.85, 0.845))
    lines = {name: row for name, row in drawn.items() if row["error"] is None}
    for depth, name in enumerate(sorted(lines, key=lambda name: lines[name]["microseconds_at_1e-8"])):
        row, colour = lines[name], PALETTE[1 + depth]
        times = [1e-6 * row[f"microseconds_at_{error}"] for error in ("1e-4", "1e-8")]
        axes.loglog(times, [1e-4, 1e-8], color=colour, marker="o", linewidth=2.0, markersize=5.0)
        missed = f", {100.0 * row['missed_at_1e-8']:.0f} % missed" if row["missed_at_1e-8"] else ""
        below = 1e-9 * 10.0 ** (-1.1 * depth)
        axes.annotate(
            f"{name}{missed} ",
            (times[1], 1e-8),
            (times[1], below),
            color=colour,
            ha="right",
            va="center",
            arrowprops={"arrowstyle": "-", "color": colour, "relpos": (1.0, 0.5), "shrinkA": 0.0},
        )
    for name in drawn.keys() - lines.keys():
        place = 1e-6 * drawn[name]["microseconds_at_1e-8"], drawn[name]["error"]
        axes.loglog(*place, color=BLACK, marker="*", markersize=16.0)
        axes.annotate(name, place, (12, 0), textcoords="offset points", va="center")
    words = "missed: share of shallow touches\nat an error of 10$^{-8}$; none elsewhere"
    axes.text(
        0.99, 0.03, words, transform=axes.transAxes, ha="right", va="bottom", color="0.4", fontsize=11.0
    )
    axes.xaxis.set_major_formatter(EngFormatter(unit="s"))
    axes.set(xlabel="time per drive period", ylabel="error", xlim=(1e-6, 0.5), ylim=(1e-17, 1e-3))
    axes.minorticks_off()
    return figure


def figure_of(width: float, height: float) -> Figure:
    """An empty figure of `width` by `height` [inches]."""
    figure = Figure(figsize=(width, height), dpi=DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    return figure


def png_of(draw: Callable[[Drawn], Figure], drawn: Drawn) -> bytes:
    """The picture with few colours, and what it shows in six digits."""
    stream, words, kept = io.BytesIO(), PngInfo(), json_text(drawn)
    with matplotlib.rc_context(LARGE):
        draw(drawn).savefig(stream, format="png", dpi=DOTS_PER_INCH)
    kept = json.dumps(json.loads(kept, parse_float=lambda digits: float(f"{float(digits):.6g}")))
    words.add_text("drawn", kept, zip=True)
    image = Image.open(stream).convert("RGB").quantize(COLOURS_KEPT, dither=Image.Dither.NONE)
    stream = io.BytesIO()
    image.save(stream, format="PNG", optimize=True, pnginfo=words)
    return stream.getvalue()


PICTURES: Mapping[str, tuple[Callable[[], Drawn], Callable[[Drawn], Figure]]] = {
    "p4": (orbit_drawn, draw_orbit),
    "costs": (costs_drawn, draw_costs),
}
"""Name -> what the picture shows, and how it is drawn."""


def pictures(given: Namespace) -> tuple[str, Mapping[str, object]]:
    """Draw both pictures, and write them when both are drawn."""
    if not can_render():
        raise InvalidValue(f"p4.png shows the spring in space, but {NO_RENDERING}")
    folder = make_folder(given.out)
    drawn = {name: png_of(draw, of()) for name, (of, draw) in PICTURES.items()}
    paths = [write_atomically(folder / f"{name}.png", content) for name, content in drawn.items()]
    return f"drawn in {' and '.join(map(str, paths))}", {"pictures": paths}


def main(argv: Sequence[str] | None = None) -> int:
    """Draw the pictures; returns 0, or 2 for wrong use and where nothing can be drawn in space."""
    parser = Parser("python -m studies pictures", __doc__ or "")
    folder = ROOT / "docs" / "pictures"
    parser.add_argument("--out", type=Path, default=folder, metavar="DIR", help="folder of the pictures")
    return tool(parser, argv, pictures)
