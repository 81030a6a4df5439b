"""A spring in motion, seen in space: one picture after another, as gif, as mp4 and as meshes for ParaView.

    scenery = Scenery.of(modes, ball_radius=2.5e-3, gap=0.0119, swing=0.013)
    with stage_of(scenery) as stage:
        write_film(run, "motion", "The motion.", stage, moments)

`Moment` says where everything is: displacements of the points of the strip, of the ball and of the base,
whether the plate is touched, and what is written above. pyvista draws off the screen where that works.
Without the libraries of OpenGL that ends in a segmentation fault which no program can catch, so that it is
tried once in a process of its own; where it does not work matplotlib draws the spring in its plane, and one
sentence names the packages that are missing.
"""

from __future__ import annotations

import importlib.util
import io
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam import BALL, BRASS, LAYER, STRIP, Material, Modes, SpringMesh, solid_spring
from studies.shell.executors import say
from studies.shell.files import write_atomically
from studies.shell.programs import needs
from studies.shell.run import Run

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
"""Rows, columns, and red, green, blue."""

NO_RENDERING = "off-screen rendering does not work here (Debian: libegl1 libegl-mesa0 libgl1-mesa-dri)"

TRIAL = (
    "import pyvista; plotter = pyvista.Plotter(off_screen=True, window_size=(32, 32)); "
    "plotter.add_mesh(pyvista.Sphere()); "
    "raise SystemExit(int(plotter.screenshot(return_img=True).std() == 0.0))"
)
PATIENCE = 120.0
"""Seconds for the trial: importing pyvista from a cold disk takes half a minute at worst."""

WIDTH, HEIGHT = 880, 400
"""Of a picture, in points; both even, as video wants them."""

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""

MOST_FRAMES = 10_000
"""Of a film: eight minutes at 20 a second, and half a gigabyte of drawn points."""

ROWS = 120
"""Rows of cells along the spring, at least: a bend looks round."""

WALL = 0.004
"""Thickness of the plate [m]."""

DRIVE = np.array([0.0, 1.0, 0.0])
"""Direction in which the base of every scene moves; x runs along the spring, z across the strip."""

TOWARDS_VIEWER = np.array([0.20, 0.30, 0.93])
"""Across the strip, a little from the side of the ball, which a wide strip would hide."""

COLOURS = {LAYER: "#4A4A4A", BALL: "#E9EDF2"}
PLATE, TOUCHED = "#8C9AA8", "#FF7A1A"
"""The plate, and its edges and all marks while it is touched."""


def metal(material: Material) -> str:
    """The colour of a strip: brass where modulus and density are within a tenth of it, or else steel."""
    same = (getattr(material, name) / getattr(BRASS, name) for name in ("youngs_modulus", "density"))
    return "#D0A62B" if all(abs(ratio - 1.0) < 0.1 for ratio in same) else "#68747F"


@dataclass(frozen=True, kw_only=True, eq=False)
class Moment:
    """Displacements of the points of the mesh relative to the base, shape (n_points, 3), and of the base
    [m]; lines of text above."""

    points: Array
    base: Array
    touched: bool = False
    lines: Sequence[str] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Scenery:
    """What is drawn: the solid spring at rest, the plate (None without one), and what holds everything.

    `plate` and `room` are boxes, the lowest and the highest corner, shape (2, 3) [m]; `strip` is a colour.
    """

    mesh: SpringMesh
    plate: Array | None
    room: Array
    strip: str

    def placed(self, moment: Moment) -> Array:
        """The points of the mesh at a moment, shape (n_points, 3) [m]."""
        points: Array = self.mesh.points + moment.points + moment.base
        return points

    @staticmethod
    def of(modes: Modes, *, ball_radius: float, swing: float, gap: float | None = None) -> Scenery:
        """The scenery of a spring that swings by `swing` [m], with a plate at `gap` [m] from the ball."""
        mesh, spring = solid_spring(modes, ball_radius=ball_radius), modes.discretization.spring
        rows = int(np.sum(mesh.part == STRIP))
        if rows < ROWS:
            mesh = solid_spring(modes, ball_radius=ball_radius, points_per_element=-(-ROWS // rows))
        held, plate = [mesh.points - swing * DRIVE, mesh.points + swing * DRIVE], None
        if gap is not None:
            ball, half = mesh.points[np.unique(mesh.triangles)].mean(axis=0), 2.0 * ball_radius
            plate = ball + (ball_radius + gap) * DRIVE + np.array([(-half, 0.0, -half), (half, WALL, half)])
            beside = ball[:2] - spring.centreline.points(spring.tip_at)[:2]
            if abs(beside[0]) > abs(beside[1]):  # a ball beyond the end: the strip passes the plate
                plate[:, 0] += math.copysign(half - 0.75 * ball_radius, beside[0])
            held.append(plate)
        cloud = np.concatenate(held)
        room, strip = np.array([cloud.min(axis=0), cloud.max(axis=0)]), metal(spring.sections[0].material)
        return Scenery(mesh=mesh, plate=plate, room=room, strip=strip)


Stage = Callable[[Moment], Picture]
Below = Callable[[int], Picture]
"""What stands below the frame of this number."""


@contextmanager
def stage_of(scenery: Scenery, *, simple: bool = False) -> Iterator[Stage]:
    """What turns a moment into a picture: pyvista where it can draw, or else, and if `simple`, matplotlib."""
    if simple or not can_render():
        if not simple:
            say(f"matplotlib draws the spring in its plane: {NO_RENDERING}")
        yield _painter(scenery)
        return
    with _plotter(scenery) as stage:
        yield stage


def prepare_off_screen() -> None:
    """Set what VTK has to know before it is imported."""
    os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


@cache
def can_render() -> bool:
    """Whether a picture could be drawn without a window; tried once."""
    prepare_off_screen()
    try:
        command = [sys.executable, "-c", TRIAL]
        return not subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False).returncode
    except (OSError, subprocess.SubprocessError):
        return False


@contextmanager
def _plotter(scenery: Scenery) -> Iterator[Stage]:
    """Pictures by pyvista, in parallel projection: equal lengths in a plane across the view stay equal."""
    prepare_off_screen()
    import pyvista

    mesh = scenery.mesh
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=[WIDTH, HEIGHT])
    plotter.set_background("white")
    grid = mesh.grid(mesh.points.copy())
    colours = {part: pyvista.Color(one).int_rgb for part, one in {**COLOURS, STRIP: scenery.strip}.items()}
    grid.cell_data["colour"] = np.array([colours[part] for part in mesh.part.tolist()], dtype=np.uint8)
    plotter.add_mesh(grid, scalars="colour", rgb=True, ambient=0.4, diffuse=0.6)
    plate = None
    if scenery.plate is not None:
        box = pyvista.Box(scenery.plate.T.ravel())
        plate = plotter.add_mesh(box, color=PLATE, edge_color=TOUCHED, line_width=5, ambient=0.4, diffuse=0.6)
    camera, centre, reach = plotter.camera, scenery.room.mean(axis=0), np.ptp(scenery.room, axis=0)
    camera.position, camera.focal_point = tuple(centre + TOWARDS_VIEWER), tuple(centre)
    camera.up, camera.parallel_projection = tuple(DRIVE), True
    camera.parallel_scale = 0.58 * max(reach[1] + 0.4 * reach[2], reach[0] * HEIGHT / WIDTH)
    plotter.show(auto_close=False)

    def picture(moment: Moment) -> Picture:
        grid.points = scenery.placed(moment)
        if plate is not None:
            plate.position, plate.prop.show_edges = tuple(moment.base), moment.touched
        plotter.render()
        return np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8)[..., :3].copy()

    try:
        yield picture
    finally:
        plotter.close()


def _painter(scenery: Scenery) -> Stage:
    """Pictures by matplotlib: the strip in its plane, ball and plate as outlines."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.patches import Circle, Rectangle

    mesh, dots = scenery.mesh, 100
    figure = Figure(figsize=(WIDTH / dots, HEIGHT / dots), dpi=dots)
    canvas, axes = FigureCanvasAgg(figure), figure.add_axes((0.0, 0.0, 1.0, 1.0))
    rows = mesh.hexahedra[mesh.part[: len(mesh.hexahedra)] == STRIP]
    rows = rows[mesh.points[rows].mean(axis=1)[:, 2] > -1e-9]  # of two legs side by side one hides the other
    ball = np.unique(mesh.triangles)
    (strip,) = axes.plot([], [], color=scenery.strip, linewidth=2.5)
    spot = axes.add_patch(Circle((0.0, 0.0), 0.5 * float(np.ptp(mesh.points[ball, 2])), color="0.5"))
    low, high = scenery.plate if scenery.plate is not None else np.zeros((2, 3))
    plate = axes.add_patch(Rectangle(low[:2], *(high - low)[:2], fc=PLATE, lw=3.0, visible=bool(high.any())))
    centre, reach = scenery.room.mean(axis=0)[:2], np.ptp(scenery.room, axis=0)
    half = 0.56 * max(reach[0] / WIDTH, reach[1] / HEIGHT) * np.array([WIDTH, HEIGHT])
    axes.set(xlim=(centre[0] - half[0], centre[0] + half[0]), ylim=(centre[1] - half[1], centre[1] + half[1]))
    axes.axis("off")

    def picture(moment: Moment) -> Picture:
        points = scenery.placed(moment)
        strip.set_data(*points[rows].mean(axis=1)[:, :2].T)
        spot.set(center=points[ball].mean(axis=0)[:2])
        plate.set(xy=(low + moment.base)[:2], edgecolor=TOUCHED if moment.touched else PLATE)
        canvas.draw()
        return np.asarray(canvas.buffer_rgba(), dtype=np.uint8)[..., :3].copy()

    return picture


def write_film(
    run: Run, name: str, holds: str, stage: Stage, moments: Sequence[Moment], *, below: Below | None = None
) -> None:
    """Film the moments with their text as NAME.gif; with what is `below` each, as NAME.mp4 too."""
    from matplotlib.font_manager import findfont
    from PIL import Image, ImageDraw, ImageFont

    font = ImageFont.truetype(findfont("DejaVu Sans"), 16)

    def framed(chosen: Iterable[int]) -> Iterator[Picture]:
        for number in chosen:
            moment = moments[number]
            parts = [stage(moment), *([below(number)] if below else [])]
            image, last = Image.fromarray(np.concatenate(parts)), len(moment.lines) - 1
            for row, line in enumerate(moment.lines):
                colour = TOUCHED if moment.touched and row == last else "#5A5A5A" if row else "black"
                ImageDraw.Draw(image).text((12, 8 + 24 * row), line, fill=colour, font=font)
            yield np.asarray(image, dtype=np.uint8)

    count, touched = len(moments), [number for number, moment in enumerate(moments) if moment.touched]
    samples = list(framed([0, count // 2, count - 1, *touched[:1]]))
    pictures = framed(run.track(range(count), "frames") if below else range(count))
    if below and can_encode():
        pictures = written_as_mp4(run.path(f"{name}.mp4", holds), pictures, RATE)
    elif below:
        run.say(needs("no mp4: it", "imageio-ffmpeg"))
    write_gif(run.path(f"{name}.gif", holds), pictures, RATE, samples=samples)


def can_encode() -> bool:
    """Whether mp4 can be written (extra `video`)."""
    return importlib.util.find_spec("imageio_ffmpeg") is not None


def write_gif(path: Path, pictures: Iterable[Picture], rate: float, *, samples: Sequence[Picture]) -> Path:
    """Write pictures at `rate` a second, repeated for ever, with one palette of `samples`: what does not
    move does not flicker. One picture after the other is taken, and kept as a byte a pixel."""
    from PIL import Image

    palette = Image.fromarray(np.concatenate(samples)).quantize(127, dither=Image.Dither.NONE)
    images = (Image.fromarray(one).quantize(palette=palette, dither=Image.Dither.NONE) for one in pictures)
    stream = io.BytesIO()
    options: Any = {"save_all": True, "append_images": images, "loop": 0, "optimize": False}
    next(images).save(stream, format="GIF", duration=10 * max(2, round(100.0 / rate)), **options)
    return write_atomically(path, stream.getvalue())


def written_as_mp4(path: Path, pictures: Iterable[Picture], rate: float) -> Iterator[Picture]:
    """Pass pictures on, their rows and columns even, and write them at `rate` a second in the H.264 format
    that browsers play."""
    import imageio_ffmpeg

    options: Any = {"fps": rate, "codec": "libx264", "quality": 8, "macro_block_size": 2}
    first = next(pictures := iter(pictures))
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        temporary, size = Path(folder) / path.name, first.shape[1::-1]
        writer = imageio_ffmpeg.write_frames(str(temporary), size, ffmpeg_log_level="error", **options)
        writer.send(None)
        for one in chain([first], pictures):
            writer.send(np.ascontiguousarray(one))
            yield one
        writer.close()
        os.replace(temporary, path)
