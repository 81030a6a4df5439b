"""The places from which users import names, and what stands there."""

import importlib
import inspect

DOORS = ("beam", "beam.space", "contact", "contact.orbits", "contact.integrators", "contact.plots")
"""Where studies get names from: what these export, and nothing behind them."""


def public() -> dict[str, object]:
    """Each public class and function once, by the first of its dotted names."""
    found: dict[str, object] = {}
    for door in DOORS:
        for name in importlib.import_module(door).__all__:
            thing = getattr(importlib.import_module(door), name)
            if (inspect.isclass(thing) or inspect.isfunction(thing)) and thing not in found.values():
                found[f"{door}.{name}"] = thing
    return found
