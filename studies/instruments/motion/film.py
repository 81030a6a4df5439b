"""Frames as a film: gif with one palette for all frames, and mp4 where ffmpeg is installed.

One palette that is not dithered keeps what does not move from flickering. Both
files are complete or absent.
"""

from __future__ import annotations

import importlib.util
import io
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studies.instruments.atomic_file import write_atomically
from studies.instruments.motion.scene_bodies import Colours

__all__ = ["NO_VIDEO", "can_encode", "write_gif", "write_mp4"]

NO_VIDEO = "no mp4: it needs imageio-ffmpeg, which the extra brings (pip install -e '.[video]')"

TINTS = 128
"""Colours of the palette; one more stands for a point that stays as it was, which makes files four times
smaller."""

SWATCH = 24
"""Height of a stripe of a colour that the palette has to have [points]."""

Frame = NDArray[np.uint8]


def can_encode() -> bool:
    """Whether mp4 can be written."""
    return importlib.util.find_spec("imageio_ffmpeg") is not None


def write_gif(path: Path, frames: Sequence[Frame], rate: float, typical: Sequence[int] = (0,)) -> Path:
    """Write frames (rows, columns, 3) at `rate` a second, repeated for ever; hundredths of a second are kept.

    The palette is made from the frames numbered in `typical`, which should hold every colour of the film.
    """
    from PIL import Image

    shown = [frames[place] for place in typical]
    montage = Image.fromarray(np.concatenate([*shown, _swatches(shown[0].shape[1])]))
    palette = montage.quantize(TINTS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    colours = (palette.getpalette() or [])[: 3 * TINTS]
    colours += [255] * (3 * (TINTS + 1) - len(colours))
    images, before = [], None
    for frame in frames:
        tints = np.asarray(Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE))
        changed = tints if before is None else np.where(tints == before, np.uint8(TINTS), tints)
        image = Image.fromarray(changed).convert("P")
        image.putpalette(colours)
        images.append(image)
        before = tints
    stream = io.BytesIO()
    images[0].save(
        stream, format="GIF", save_all=True, append_images=images[1:], loop=0, optimize=False,
        duration=10 * max(2, round(100.0 / rate)), transparency=TINTS, disposal=1,
    )  # fmt: skip
    return write_atomically(path, stream.getvalue())


def _swatches(width: int) -> Frame:
    """Stripes of the colours that stand for something: a palette keeps them although they cover little."""
    from matplotlib.colors import to_rgb

    from studies.instruments.figures import PALETTE

    colours = [to_rgb(colour) for colour in (*PALETTE[1:4], Colours.flash)]
    stripes = np.repeat(np.round(255.0 * np.array(colours)).astype(np.uint8), SWATCH, axis=0)
    return np.repeat(stripes[:, None], width, axis=1)


def write_mp4(path: Path, frames: Sequence[Frame], rate: float) -> Path:
    """Write frames (rows, columns, 3), both even, at `rate` a second in the H.264 format that browsers
    play."""
    import imageio_ffmpeg

    rows, columns, _ = frames[0].shape
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        temporary = Path(folder) / path.name
        writer = imageio_ffmpeg.write_frames(
            str(temporary), (columns, rows), fps=rate, codec="libx264", pix_fmt_out="yuv420p", quality=8,
            macro_block_size=2, ffmpeg_log_level="error",
        )  # fmt: skip
        writer.send(None)
        for frame in frames:
            writer.send(np.ascontiguousarray(frame))
        writer.close()
        os.replace(temporary, path)
    return path
