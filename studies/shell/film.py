"""A spring in motion, seen in space: one picture after another, as gif and as mp4.

    scenery = Scenery.of(modes, ball_radius=2.5e-3, gap=0.0119, swing=0.013)
    write_film(run, "motion", "The motion.", stage_of(scenery), moments)

`Moment` says where everything is: displacements of the points of the strip, of the ball and of the base,
whether the plate is touched, and what is written above. What is seen is drawn by matplotlib, without any
graphics library: outer faces that look to the viewer, the farthest first, in parallel projection.
"""

from __future__ import annotations

import importlib.util
import io
import math
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from beam import BALL, LAYER, STRIP, Modes, SpringMesh, solid_spring
from studies.shell.files import write_atomically
from studies.shell.programs import needs
from studies.shell.run import Run
from studies.shell.scene.spring import metal_of

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
"""Rows, columns, and red, green, blue."""

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
BRASS, OTHER = "#D0A62B", "#68747F"
"""Strips of brass, and of steel or anything else."""
PLATE, TOUCHED = "#8C9AA8", "#FF7A1A"
"""The plate, and its edges and all marks while it is touched."""


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

    `plate` and `room` are boxes, the lowest and the highest corner, shape (2, 3) [m]; `strip` is a colour,
    and `more` are boxes that stand still, with their colours.
    """

    mesh: SpringMesh
    plate: Array | None
    room: Array
    strip: str
    more: tuple[tuple[Array, str], ...] = ()

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
        room, strip = (
            np.array([cloud.min(axis=0), cloud.max(axis=0)]),
            BRASS if metal_of(spring.sections[0].material) == "brass" else OTHER,
        )
        return Scenery(mesh=mesh, plate=plate, room=room, strip=strip)


def box(corners: Array, pieces: int = 8) -> Array:
    """Faces of a box, shape (n, 4, 3), cut into `pieces` each way: what is near one side of it is sorted."""
    low, high = corners
    u, v = (part.ravel() for part in np.mgrid[0:pieces, 0:pieces])
    square = np.array([(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)]) / pieces
    faces = []
    for axis in range(3):
        across = (axis + 1) % 3, (axis + 2) % 3
        for end in (0.0, 1.0):
            unit = np.empty((4, pieces**2, 3))
            unit[..., across], unit[..., axis] = square.transpose(0, 2, 1)[:: 1 if end else -1], end
            faces.append(low + unit * (high - low))
    return np.concatenate(faces, axis=1).transpose(1, 0, 2)


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """A parallel projection into a window that is `half` wide and high on each side of `centre` [m].

    The rows of `axes` point right, up and towards the viewer.
    """

    axes: Array
    centre: Array
    half: Array

    @staticmethod
    def of(towards: Array, room: Array, aspect: float) -> View:
        """The view from `towards` of all that is in the box `room`; `aspect` is height over width."""
        towards = towards / np.linalg.norm(towards)
        right = np.cross(DRIVE, towards)
        axes = np.array([right / np.linalg.norm(right), np.zeros(3), towards])
        axes[1] = np.cross(towards, axes[0])
        corners = np.array(list(product(*room.T))) @ axes.T
        low, high = corners.min(axis=0), corners.max(axis=0)
        wide = 0.53 * max(high[0] - low[0], (high[1] - low[1]) / aspect)
        return View(axes=axes, centre=0.5 * (low + high) @ axes, half=np.array([wide, wide * aspect]))

    def __call__(self, points: Array) -> Array:
        """Places in the window, from -1 to 1 each way, shape (..., 2)."""
        places: Array = (points - self.centre) @ self.axes[:2].T / self.half
        return places

    def painted(self, faces: Array, colours: Array) -> tuple[Array, Array]:
        """Faces in the window and their shaded colours, (n, 4, 2) and (n, 3), the farthest first."""
        normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        light = normal @ self.axes[2] / np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
        order = np.argsort(faces.mean(axis=1) @ self.axes[2])
        order = order[light[order] > 0.0]
        return self(faces[order]), colours[order] * (0.5 + 0.5 * light[order, None])


def outline(places: Array) -> Array:
    """The line around places in a window, closed."""
    around = ConvexHull(places).vertices
    found: Array = places[[*around, around[0]]]
    return found


Stage = Callable[[Moment], Picture]
Below = Callable[[int], Picture]
"""What stands below the frame of this number."""


def stage_of(
    scenery: Scenery, towards: Array = TOWARDS_VIEWER, size: tuple[int, int] = (WIDTH, HEIGHT)
) -> Stage:
    """What turns a moment into a picture of `size` points, seen from `towards`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.figure import Figure

    (quads, part), triangles = scenery.mesh.surface(), scenery.mesh.triangles
    corners = np.concatenate([quads, triangles[:, [0, 1, 2, 2]]])
    plate = np.empty((0, 4, 3)) if scenery.plate is None else box(scenery.plate)
    still = [(box(corner), colour) for corner, colour in scenery.more]
    names = {**COLOURS, STRIP: scenery.strip}
    named = [names[one] for one in [*part.tolist(), *[BALL] * len(triangles)]] + [PLATE] * len(plate)
    colours = np.array([to_rgb(one) for one in [*named, *(c for faces, c in still for _ in faces)]])
    view, dots = View.of(towards, scenery.room, size[1] / size[0]), 100
    figure = Figure(figsize=(size[0] / dots, size[1] / dots), dpi=dots)
    canvas, axes = FigureCanvasAgg(figure), figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(-1, 1), ylim=(-1, 1))
    seen = axes.add_collection(PolyCollection([], linewidths=0.4))
    (edge,) = axes.plot([], [], color=TOUCHED, linewidth=2.5)
    axes.axis("off")

    def picture(moment: Moment) -> Picture:
        faces = [scenery.placed(moment)[corners], plate + moment.base, *(one for one, _ in still)]
        places, shades = view.painted(np.concatenate(faces), colours)
        seen.set(verts=places, facecolors=shades, edgecolors=shades)
        edge.set_data(*(outline(view(faces[1].reshape(-1, 3))).T if moment.touched else ((), ())))
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
