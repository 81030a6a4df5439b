"""What `help` shows: public names, fields and parameters explained, and of each study how it is run."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import pkgutil
import re

import pytest

import beam
import contact
import studies

MODULES = [
    info.name
    for package in (beam, contact)
    for info in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
]


def public_objects(module):
    """Classes and plain functions that a module defines for others."""
    for name, thing in vars(module).items():
        ours = getattr(thing, "__module__", None) == module.__name__
        if not name.startswith("_") and ours and (inspect.isclass(thing) or inspect.isfunction(thing)):
            yield name, thing


@pytest.mark.parametrize("name", MODULES)
def test_every_class_function_and_method_says_what_it_is(name):
    module = importlib.import_module(name)
    assert (module.__doc__ or "").strip()
    for what, thing in public_objects(module):
        assert inspect.getdoc(thing), f"{name}.{what}"
        for member, value in vars(thing).items() if inspect.isclass(thing) else ():
            function = value.fget if isinstance(value, property) else getattr(value, "func", value)
            if not member.startswith("_") and inspect.isfunction(function):
                assert inspect.getdoc(getattr(thing, member)), f"{name}.{what}.{member}"


@pytest.mark.parametrize("package", [beam, contact], ids=lambda package: package.__name__)
def test_fields_and_parameters_of_public_names_are_explained(package):
    """Each name stands in the docstring of its class or function, or of the class that it comes from."""
    unexplained = []
    for name in package.__all__:
        thing = getattr(package, name)
        if dataclasses.is_dataclass(thing) and inspect.isclass(thing):
            told = " ".join(inspect.getdoc(k) or "" for k in thing.__mro__)
            wanted = [field.name for field in dataclasses.fields(thing) if not field.name.startswith("_")]
        elif inspect.isfunction(thing):
            told, wanted = inspect.getdoc(thing) or "", list(inspect.signature(thing).parameters)
        else:
            continue
        unexplained += [f"{name}: {part}" for part in wanted if not re.search(rf"\b{part}\b", told)]
    assert not unexplained


@pytest.mark.parametrize("package", [beam, contact, studies], ids=lambda package: package.__name__)
def test_help_opens_with_a_page_on_the_subject(package):
    assert len((package.__doc__ or "").split()) > 150
