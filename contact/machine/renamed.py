"""Old names of functions and modules: each forwards to the new one with a DeprecationWarning."""

import sys
import warnings
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import TypeVar

T = TypeVar("T")


def forwarded_call(old: str, new: str, function: Callable[..., T]) -> Callable[..., T]:
    """The callable `function` for an `old` name: a call warns that it is now written as `new`."""

    def called(*args: object, **named: object) -> T:
        warnings.warn(f"{old} is now {new}", DeprecationWarning, stacklevel=2)
        return function(*args, **named)

    return called


def forward_modules(table: dict[str, str]) -> None:
    """Make modules importable by the old names of `table`, old -> new; reading a name from one warns."""
    for old, new in table.items():

        def value_of(name: str, old: str = old, new: str = new) -> object:
            if name.startswith("__"):
                raise AttributeError(f"module {old!r} has no attribute {name!r}")
            value = getattr(import_module(new), name)
            warnings.warn(f"{old} is now {new}", DeprecationWarning, stacklevel=2)
            return value

        module = ModuleType(old, f"This module is now ``{new}``.")
        module.__getattr__ = value_of  # type: ignore[method-assign]
        sys.modules[old] = module
        parent, _, name = old.rpartition(".")
        if not hasattr(sys.modules[parent], name):
            setattr(sys.modules[parent], name, module)
