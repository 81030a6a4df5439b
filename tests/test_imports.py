"""The structure of the packages: who imports whom, what importing costs, what is public, what is shipped."""

from __future__ import annotations

import ast
import importlib
import json
import shutil
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

#: A file imports only files above it. A name that ends in .* stands for every file of a subpackage.
ORDER = {
    "beam": (
        "parameters",
        "material",
        "section",
        "centreline",
        "spring",
        "spring_shapes",
        "pieces",
        "strip_element",
        "assembly",
        "frequency_equation",
        "modes",
        "damping",
        "modal_model",
        "reduction",
        "guided_leg",
        "space.section",
        "space.spring",
        "space.element",
        "space.modes",
        "space",
        "spring_mesh",
        "export",
    ),
    "contact": (
        "compiled",
        "errors",
        "vector_loops",
        "trajectory",
        "drive",
        "laws",
        "stop",
        "flight.elementary",
        "flight.motion",
        "flight.modal_flow",
        "flight.bounds",
        "flight.polynomial_root",
        "flight.tip_search",
        "flight.crossing",
        "flight.sampled_crossing",
        "flight",
        "oscillator",
        "recorder",
        "touch.series",
        "touch.time_series",
        "touch.newton",
        "touch.delayed",
        "touch.linear",
        "touch.hertz",
        "touch",
        "touch.tangents",
        "event_loop",
        "exact_run",
        "integrators.*",
        "simulation",
        "single_mode.*",
        "single_mode",
        "strobed_map",
        "strobed_motion",
        "touch_flow",
        "stroboscope",
        "virtual_motion",
        "collision",
        "nordmark",
        "maximal_orbits",
        "orbits.family",
        "orbits.single_impact",
        "orbits.kick",
        "orbits.periodic_orbit",
        "orbits.events",
        "orbits.continuation",
        "orbits.shooting",
        "orbits.repetition",
        "orbits.settling",
        "orbits.scan",
        "orbits.ends",
        "orbits.amplitude_scan",
        "orbits.lyapunov",
        "orbits",
        "warm_up",
    ),
}

SLOW = ("pyvista", "vtkmodules", "matplotlib", "meshio")


def name_of(path: Path, root: Path = ROOT) -> str:
    """Dotted name of a module."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules(package: str, root: Path = ROOT) -> dict[str, Path]:
    return {name_of(path, root): path for path in sorted((root / package).rglob("*.py"))}


def imports_of(name: str, path: Path) -> set[tuple[str, str]]:
    """(module, name in it or "") of every import in a file, also of those inside functions."""
    base = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    found: set[tuple[str, str]] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {(alias.name, "") for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            start = base[: len(base) + 1 - node.level] if node.level else []
            module = ".".join([*start, *([node.module] if node.module else [])])
            found |= {(module, alias.name) for alias in node.names}
    return found


def graph(package: str, root: Path = ROOT) -> dict[str, set[str]]:
    """Module -> the modules of the same package that it imports."""
    known = modules(package, root)
    edges: dict[str, set[str]] = {}
    for name, path in known.items():
        targets = set()
        for module, imported in imports_of(name, path):
            full = f"{module}.{imported}" if imported else module
            targets.add(full if full in known else module)
        edges[name] = {target for target in targets if target in known and target != name}
    return edges


def rank(package: str, name: str) -> int:
    """Place of a module in `ORDER`; the package itself comes last, it gathers the others."""
    if name == package:
        return len(ORDER[package])
    short = name.removeprefix(f"{package}.")
    slot = short if short in ORDER[package] else f"{short.split('.')[0]}.*"
    if slot not in ORDER[package]:
        raise AssertionError(f"{name} has no place in the order of {package}: add it where it belongs")
    return ORDER[package].index(slot)


def breaches(package: str, root: Path = ROOT) -> list[str]:
    found = []
    for name, targets in graph(package, root).items():
        for target in targets:
            here, there = rank(package, name), rank(package, target)
            inside = here == there < len(ORDER[package]) and ORDER[package][here].endswith(".*")
            if not (there < here or inside):
                found.append(f"{name} imports {target}")
    return found


@pytest.mark.parametrize("package", sorted(ORDER))
def test_files_import_only_files_above_them(package):
    assert not breaches(package)
    tuple(TopologicalSorter(graph(package)).static_order())  # no cycles, not even inside a subpackage


def test_the_order_would_notice_a_file_that_imports_downwards(tmp_path):
    (tmp_path / "beam").mkdir()
    (tmp_path / "beam" / "material.py").write_text("def f():\n    from .section import StripSection\n")
    (tmp_path / "beam" / "section.py").write_text("import beam.material\n")
    assert breaches("beam", tmp_path) == ["beam.material imports beam.section"]
    (tmp_path / "beam" / "helpers.py").write_text("")
    with pytest.raises(AssertionError, match="no place"):
        rank("beam", "beam.helpers")


def foreign(package: str, others: tuple[str, ...]) -> set[tuple[str, str]]:
    return {
        (module, imported)
        for name, path in modules(package).items()
        for module, imported in imports_of(name, path)
        if module.split(".")[0] in others
    }


def test_the_beam_knows_nothing_of_contact_and_studies():
    assert not foreign("beam", ("contact", "studies", "tests"))


def test_contact_sees_of_the_beam_only_the_modal_model():
    seen = {entry for entry in foreign("contact", ("beam",)) if entry[0] != "beam.parameters"}  # refusals
    assert seen <= {("beam", "ModalModel")}
    assert not foreign("contact", ("studies", "tests"))


def test_studies_import_no_private_names():
    private = {(m, n) for m, n in foreign("studies", ("beam", "contact")) if n.startswith("_")}
    assert not private


@pytest.mark.parametrize(
    ("statement", "unwanted"),
    [
        ("import beam", ("numpy", "scipy", "skfem")),
        ("import contact", ("skfem", "scipy.optimize", *SLOW)),
        ("import beam.export, beam.space", SLOW),
        ("import studies.modes", SLOW),
    ],
)
def test_slow_packages_are_imported_only_where_they_are_used(statement, unwanted):
    code = f"{statement}; import json, sys; print(json.dumps(sorted(sys.modules)))"
    command = [sys.executable, "-c", code]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert not set(json.loads(answer.stdout)) & set(unwanted)


@pytest.mark.parametrize("package", ["beam", "contact"])
def test_public_names_exist_and_are_sorted(package):
    module = importlib.import_module(package)
    names = list(module.__all__)
    assert names == sorted(names) and len(names) == len(set(names)) > 0
    for name in names:
        assert getattr(module, name) is not None
    seen_by_type_checkers = {
        node.asname or node.name
        for statement in ast.walk(ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8")))
        if isinstance(statement, ast.ImportFrom) and (statement.level or statement.module.startswith(package))
        for node in statement.names
    }
    assert seen_by_type_checkers == set(names)


def test_what_is_shipped_has_the_scenes_and_the_types(tmp_path):
    """The content of a wheel: what setuptools' build_py copies."""
    source, built = tmp_path / "source", tmp_path / "built"
    source.mkdir()
    for package in ("beam", "contact", "studies"):
        shutil.copytree(ROOT / package, source / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", source)
    (source / "README.md").write_text("")
    command = [sys.executable, "-c", "import setuptools; setuptools.setup()", "-q", "build_py"]
    subprocess.run([*command, "--build-lib", str(built)], cwd=source, check=True, capture_output=True)
    shipped = {path.relative_to(built).as_posix() for path in built.rglob("*") if path.is_file()}
    here = {
        path.relative_to(ROOT).as_posix()
        for package in ("beam", "contact", "studies")
        for pattern in ("*.py", "py.typed", "*.toml", "*.j2")
        for path in (ROOT / package).rglob(pattern)
    }
    assert here <= shipped
    assert {"beam/py.typed", "contact/py.typed", "studies/py.typed", "studies/scenes/letter.toml"} <= shipped
    assert not any(name.startswith(("tests", "results")) for name in shipped)
