"""Films of a spring in motion, as gif and as mp4.

    scenery = Scenery.of(modes, ball_radius=2.5e-3, gaps=[0.0119], amplitude=0.013)
    write_film(run, "motion", "The motion.", stage_of(scenery), moments)

``studies.shell.painter`` draws each moment; here the pictures become files.
"""

from __future__ import annotations

import importlib.util
import io
import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from studies.shell.files import write_atomically
from studies.shell.painter import Moment, Picture, Stage
from studies.shell.programs import needs
from studies.shell.run import Run

RATE = 20.0
"""Frames a second: gif keeps time in hundredths of a second."""

MOST_FRAMES = 10_000
"""Of a film: eight minutes at 20 a second, and half a gigabyte of drawn points."""


def write_film(
    run: Run, name: str, holds: str, stage: Stage, moments: Sequence[Moment], *, video: bool = False
) -> None:
    """Film the moments as NAME.gif, and with `video` as NAME.mp4, too; the run keeps what it `holds`."""
    count, touched = len(moments), [moment for moment in moments if any(moment.touched)]
    samples = [stage(one) for one in (moments[0], moments[count // 2], moments[-1], *touched[:1])]
    pictures: Iterator[Picture] = map(stage, run.track(moments, "frames") if video else moments)
    if video and can_encode():
        pictures = written_as_mp4(run.path(f"{name}.mp4", holds), pictures, RATE)
    elif video:
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
    lasts = 10 * max(2, round(100.0 / rate))
    next(images).save(
        stream, "GIF", duration=lasts, save_all=True, append_images=images, loop=0, optimize=False
    )
    return write_atomically(path, stream.getvalue())


def written_as_mp4(path: Path, pictures: Iterable[Picture], rate: float) -> Iterator[Picture]:
    """Pass pictures on, their rows and columns even, and write them at `rate` a second in the H.264 format
    that browsers play."""
    import imageio_ffmpeg

    first = next(pictures := iter(pictures))
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        temporary, size = Path(folder) / path.name, first.shape[1::-1]
        form = {"codec": "libx264", "quality": 8, "macro_block_size": 2, "ffmpeg_log_level": "error"}
        writer = imageio_ffmpeg.write_frames(str(temporary), size, fps=rate, **form)
        writer.send(None)
        for one in chain([first], pictures):
            writer.send(np.ascontiguousarray(one))
            yield one
        writer.close()
        os.replace(temporary, path)
