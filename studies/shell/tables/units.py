"""Units as headings write them: their dimension (m, m/s, m/s² or s) and how many SI units each is.

A heading has its unit in brackets (`x (mm)`), after `in` or a slash, or behind its last underscore (`x_mm`).
"""

import re

GRAVITY = 9.80665  # standard acceleration of free fall [m/s²]
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9, "in": 0.0254, "km": 1e3}
TIMES = {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
UNITS = {name: ("s", size) for name, size in TIMES.items()}
for _name, _size in LENGTHS.items():
    UNITS |= {_name: ("m", _size), f"{_name}/s": ("m/s", _size), f"{_name}/s2": ("m/s²", _size)}
UNITS |= {"g": ("m/s²", GRAVITY), "mg": ("m/s²", 1e-3 * GRAVITY)}
WORDS = {
    **dict.fromkeys(("sec", "second", "seconds", "sekunde", "sekunden"), "s"),
    **dict.fromkeys(("millis", "millisecond", "milliseconds", "millisekunden", "msec"), "ms"),
    **dict.fromkeys(("micros", "microsecond", "microseconds", "mikrosekunden", "usec"), "µs"),
    **{"micron": "µm", "microns": "µm", "meter": "m", "metre": "m", "minutes": "min", "minuten": "min"},
}
OTHERS = set("v volt volts mv a ma n kn hz 1 - counts count pa kpa bar °c c k % deg rad adc".split())
TIME_WORDS = set("t time times zeit timestamp stamp elapsed uhrzeit zeitstempel x_value x-axis".split())
COUNT_WORDS = {"", "unnamed: 0", *"count sample samples index n no nr i row x frame".split()}
_BRACKETS = re.compile(r"^(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$")
_AFTER = re.compile(r"^(.*?)(?:\s+in\s+|\s*/\s*|_)(\S+)$")


def plain(unit: str) -> str:
    """A unit without brackets, in one of the spellings of `UNITS` if it is known."""
    text = unit.strip(" []()").replace("_per_", "/").replace("\u03bc", "µ").replace("²", "2")
    text = re.sub(r"\^|\*\*|\s", "", text).replace("/s/s", "/s2").replace("/sec", "/s").replace("s^-", "s-")
    text = re.sub(r"^u(?=[ms](/|$))", "µ", re.sub(r"[·*.]?s-([12])$", r"/s\1", text)).replace("/s1", "/s")
    lower = WORDS.get(text.lower(), text.lower())
    return text if text in UNITS else lower if lower in UNITS else text


def known(unit: str) -> tuple[str, float]:
    """Dimension and size of a unit, "" and 1 if it is unknown."""
    return UNITS.get(plain(unit), ("", 1.0))


def is_unit(text: str) -> bool:
    """Whether a cell below a heading is a unit."""
    return plain(text) in UNITS or plain(text).lower() in OTHERS


def split(heading: str) -> tuple[str, str]:
    """The name and the unit, "" if none, of a heading such as `Weg [mm]`."""
    if found := _BRACKETS.match(heading):
        return found[1] or heading, found[2]
    before, per, rest = heading.partition("_per_")
    if (found := _AFTER.match(before)) and found[2] not in ("x", "min", "h", "1"):
        unit = found[2] + per + rest
        if is_unit(unit):
            return found[1], unit
    return heading, ""


def is_time(heading: str, unit: str) -> bool:
    """Whether a column is a time, by its unit or, if that is unknown, by the first word of its name."""
    if dimension := known(unit)[0]:
        return dimension == "s"
    name = split(heading)[0].lower()
    words = {name, re.split("[ _]", name)[0]}
    return bool(words & (TIME_WORDS | WORDS.keys()) - {"meter", "metre"})
