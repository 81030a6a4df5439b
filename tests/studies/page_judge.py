"""What a reader may find on a page of results."""

import re
from pathlib import Path

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
