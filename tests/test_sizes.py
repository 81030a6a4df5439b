"""Sizes, by which one sees that each idea stands once: files and functions; ruff counts parameters."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
KERNELS = {"kernel", "inlined", "part"}
"""Decorators of ``contact.machine.compiled``: such functions may be longer, for a call costs them time."""


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


@pytest.mark.parametrize("package", ["beam", "contact", "studies", "tests"])
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


def test_few_types_are_left_open():
    """How often code says `Any`, imports left out."""
    counts = dict.fromkeys(("beam", "contact", "studies"), 0)
    for package in counts:
        nodes = (node for _, text in files(package) for node in ast.walk(ast.parse(text)))
        counts[package] = sum(isinstance(node, ast.Name) and node.id == "Any" for node in nodes)
    assert sum(counts.values()) <= 100, counts
