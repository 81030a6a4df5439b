"""What a reader may find on a page of results and in a figure."""

import re
from collections.abc import Callable
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from studies.shell.options import style_of

#: What stands on no page between tags: JSON, a list, Python's words, many digits, a sign as a hyphen, markup.
UNFIT = re.compile(
    r"[{}]|\[\d+[,.]|\bTrue\b|\bFalse\b|\bNone\b|\bnan\b|\d\.\d{9}|(?<![\w.)\]-])-\d|\de[-+]\d|\$|`|\w_hz\b|"
    r"\b(?P<number>[\d.]+) to (?P=number)\b(?![.\d])|\b0 of \d"
)


def seen(text: str) -> str:
    """The text of a page, without commands, formulas and names of files."""
    text = re.sub(r"<(style|pre|code|script)\b.*?</\1>", "", text, flags=re.DOTALL)
    return re.sub(r"<[^>]*>", "\n", re.sub(r"<a href=[^>]*>[^<]*\.\w+</a>", "", text))


def assert_fit(page: Path) -> None:
    """No line that a reader sees holds what no page may show."""
    text = page.read_text()
    assert_balanced(text)
    unfit = [line.strip() for line in seen(text).splitlines() if UNFIT.search(line)]
    assert not unfit, unfit


def assert_balanced(text: str) -> None:
    """Every element that is opened is closed, in order."""
    opened: list[str] = []
    for closing, tag in re.findall(r"<(/?)([a-z]\w*)", text):
        if closing:
            assert opened and opened.pop() == tag, tag
        elif tag not in ("meta", "link", "img", "br"):
            opened.append(tag)
    assert opened == []


def in_both_styles(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """A function that draws, for paper and as a slide, where no text overprints another or is cut off."""

    def drawn(*of: object) -> Figure:
        texts, by = list[Text](), Text.draw
        for style in ("slide", "paper"):
            texts.clear()
            with style_of(style), pytest.MonkeyPatch.context() as patch:
                figure = draw(*of)
                patch.setattr(Text, "draw", lambda one, renderer: (texts.append(one), by(one, renderer)))
                figure.canvas.draw()
            shown = [one for one in dict.fromkeys(texts) if one.get_visible() and one.get_text()]
            boxes = {one: one.get_window_extent() for one in shown}
            pairs = combinations(boxes.items(), 2)
            lap = [(a, b) for (a, x), (b, y) in pairs if all(np.fmin(x.max, y.max) > np.fmax(x.min, y.min))]
            both = [f"{a.get_text()}|{b.get_text()}" for a, b in lap]
            cut = [a.get_text() for a, x in boxes.items() if min(x.min) < 0 or any(x.max > figure.bbox.max)]
            assert len(boxes) > 20 and not both + cut, (style, len(boxes), both + cut)
        return figure

    return drawn
