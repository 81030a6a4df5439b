"""Sizes, by which one sees that each idea stands once: files and functions; ruff counts parameters."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
KERNELS = {"kernel", "inlined", "part"}
"""Decorators of ``contact.compiled``: such functions may be longer, for a call costs them time."""


def files(package: str) -> Iterator[tuple[str, str]]:
    """(dotted name, text) of every file of a package."""
    for path in sorted((ROOT / package).rglob("*.py")):
        yield ".".join(path.relative_to(ROOT).with_suffix("").parts), path.read_text(encoding="utf-8")


def functions(package: str) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    for name, text in files(package):
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{name}.{node.name}", node


def lines_of(node: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Lines of a function, without decorators and docstring."""
    text = node.body[0] if ast.get_docstring(node) is not None else None
    return node.end_lineno - node.lineno + 1 - (text.end_lineno - text.lineno + 1 if text else 0)


@pytest.mark.parametrize("package", ["beam", "contact", "studies"])
def test_no_file_is_over_300_lines(package):
    assert {name: n for name, text in files(package) if (n := len(text.splitlines())) > 300} == {}


@pytest.mark.parametrize("package", ["beam", "contact"])
def test_no_function_is_over_60_lines_and_no_kernel_over_90(package):
    long = {}
    for name, node in functions(package):
        compiled = any(isinstance(one, ast.Name) and one.id in KERNELS for one in node.decorator_list)
        if lines_of(node) > (90 if compiled else 60):
            long[name] = lines_of(node)
    assert long == {}


def any_in(text: str) -> int:
    """How often a file's code says `Any`, its import left out."""
    return sum(isinstance(node, ast.Name) and node.id == "Any" for node in ast.walk(ast.parse(text)))


def test_types_are_told():
    every = [one for package in ("beam", "contact", "studies") for one in files(package)]
    counts = {name: any_in(text) for name, text in every}
    assert sum(counts.values()) <= 100, {name: n for name, n in counts.items() if n}


def test_the_counts_would_notice():
    assert any_in("from typing import Any\nx: dict[str, Any] = {}\ndef f(a: Any, b: int) -> Any: ...\n") == 3
    source = 'def long(self, a, *b, c=1, **d):\n    """One\n    two."""\n    x = 1\n    return x\n'
    node = ast.parse(source).body[0]
    assert lines_of(node) == 3
