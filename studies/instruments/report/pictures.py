"""Pictures of the results as data URIs, so that the page needs no other file.

Size in pixels is read from the head of the file. Once the pictures of a page add up to `MOST_BYTES`, further
ones are linked instead: a page above 25 MB is slow to open.
"""

from __future__ import annotations

import base64
import os
import struct
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

MOST_BYTES = 17_000_000
"""Bytes of pictures in one page; base64 makes 23 MB of them."""

PNG, GIF = b"\x89PNG\r\n\x1a\n", b"GIF8"
CSS_PIXELS_PER_PIXEL = 0.62
"""Figures have 200 dots per inch: on screen they stand a quarter larger than printed."""


class NoPicture(ValueError):
    """The file is no picture; the message is one sentence."""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A picture with its width and height on the page [CSS pixels]."""

    path: Path
    kind: str
    width: int
    height: int
    content: bytes

    @property
    def uri(self) -> str:
        return f"data:image/{self.kind};base64,{base64.b64encode(self.content).decode('ascii')}"


def read(path: Path) -> Picture:
    """The picture in a file, PNG or GIF."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise NoPicture(f"{path.parent.name}/{path.name} cannot be read: {error.strerror}.") from error
    if content.startswith(PNG) and len(content) > 24:
        kind, (width, height) = "png", struct.unpack(">II", content[16:24])
    elif content.startswith(GIF) and len(content) > 10:
        kind, (width, height) = "gif", struct.unpack("<HH", content[6:10])
    else:
        raise NoPicture(f"{path.parent.name}/{path.name} is not a picture.")
    if not width or not height:
        raise NoPicture(f"{path.parent.name}/{path.name} is an empty picture.")
    scale = CSS_PIXELS_PER_PIXEL if kind == "png" else 1.0
    return Picture(
        path=path, kind=kind, width=round(scale * width), height=round(scale * height), content=content
    )


def link_to(path: Path, page_folder: Path) -> str:
    """Relative address of a file as seen from the page."""
    return quote(Path(os.path.relpath(path, page_folder)).as_posix())
