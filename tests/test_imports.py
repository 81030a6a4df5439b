"""Who imports whom, what importing costs, what is public, what is shipped."""

import ast
import importlib
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from public_names import DOORS

from studies.shell.programs import CHAPTERS, chapter, needs

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("beam", "contact", "studies")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]

FLOORS = {
    "beam": "record parameters material section centreline spring spring_shapes pieces strip_element "
    "assembly modes damping point matrices exciter residual_mode modal_test modal_model one_mode derivatives "
    "reduction frequency_equation large_amplitude spring_mesh space export __init__",
    "contact": "errors machine speed_table restitution laws hertz stop drive flight plausible "
    "steady_response oscillator state tables plots impacts trajectory touch engine integrators simulation "
    "sensitivity one_mode maps virtual_motion collision_numbers collision orbits.families orbits.branches "
    "orbits.shooting orbits.observation orbits.__init__ __init__ warm_up",
    "studies": "__init__ letter shell.files shell.programs shell.tables.units shell.tables.formats "
    "shell.tables.text shell.tables.binary shell.scene shell physics shell.study "
    "shell.every_study experiment spring methods measurement.next_measurement "
    "measurement.identify.record measurement.identify.motion measurement.identify.fit measurement "
    "explore pictures tour report __main__",
}
"""Files and folders in the order in which they build on each other: none imports a later one."""

SLOW = ("matplotlib", "meshio", "pyvista", "skfem", "vtkmodules")


def name_of(path: Path, root: Path) -> str:
    """Dotted name of a module."""
    return ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")


def modules(package: str, root: Path = ROOT) -> dict[str, Path]:
    return {name_of(path, root): path for path in sorted((root / package).rglob("*.py"))}


def imports_of(name: str, path: Path) -> Iterator[tuple[str, str]]:
    """(module, name in it or "") of every import in a file, also of those inside functions."""
    base = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = base[: len(base) + 1 - node.level] if node.level else []
            module = ".".join([*start, *([node.module] if node.module else [])])
            yield from ((module, alias.name) for alias in node.names)


def graph(package: str, root: Path = ROOT) -> dict[str, set[str]]:
    """Module -> the modules of the same package that it imports."""
    known, edges = modules(package, root), {}
    for name in known:
        pairs = [(module, f"{module}.{imported}") for module, imported in imports_of(name, known[name])]
        edges[name] = {full if full in known else module for module, full in pairs} & (known.keys() - {name})
    return edges


def faults(package: str, root: Path = ROOT) -> list[str]:
    """Imports of a later floor, and files without a floor; a file has the floor with the longest name."""
    files, floors, edges = modules(package, root), FLOORS[package].split(), graph(package, root)
    list(TopologicalSorter(edges).static_order())  # raises where imports go round in a circle
    paths = {name: ".".join(files[name].relative_to(root / package).with_suffix("").parts) for name in files}
    of = {name: [one for one in floors if f"{path}.".startswith(f"{one}.")] for name, path in paths.items()}
    place = {name: floors.index(max(found, key=len)) for name, found in of.items() if found}
    assert set(place.values()) == set(range(len(floors))), "a floor has no file"
    above = [(name, other) for name in place for other in edges[name] if place.get(other, -1) > place[name]]
    return [f"{name} has no floor" for name in files.keys() - place] + [f"{a} imports {b}" for a, b in above]


@pytest.mark.parametrize("package", FLOORS)
def test_no_import_runs_up(package):
    assert faults(package) == []


def test_an_import_that_runs_up_is_seen_and_so_is_a_file_without_a_floor(tmp_path):
    shutil.copytree(ROOT / "contact", tmp_path / "contact", ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "contact" / "cellar.py").touch()
    with (tmp_path / "contact" / "maps" / "protocol.py").open("a") as file:
        file.write("def late():\n    from contact.collision import collisions\n")
    found = ["contact.cellar has no floor", "contact.maps.protocol imports contact.collision"]
    assert faults("contact", tmp_path) == found


def foreign(package: str) -> set[tuple[str, str, str]]:
    """(who, module, name) of the imports from the other packages."""
    return {
        (name, module, imported)
        for name, path in modules(package).items()
        for module, imported in imports_of(name, path)
        if module.split(".")[0] in {*PACKAGES, "tests"} - {package}
    }


def test_the_beam_knows_nothing_of_the_others_and_contact_little_of_the_beam():
    """Contact sees the modal model, made by hand or reduced, the words of refusal and the printed record."""
    assert foreign("beam") == set()
    words = ("beam.parameters", "beam.record")
    seen = {(module, name) for _, module, name in foreign("contact") if module not in words}
    assert seen <= {("beam", "ModalChange"), ("beam", "ModalModel"), ("beam", "single_mode")}


@pytest.mark.parametrize("package", ["beam", "contact"])
def test_tests_of_a_library_import_nothing_of_studies(package):
    """Nor do the helpers of these tests, so that a change of a scene changes none of them."""
    files = modules(f"tests/{package}")
    assert files
    used = {(name, module) for name, path in files.items() for module, _ in imports_of(name, path)}
    assert [entry for entry in used if entry[1].partition(".")[0] == "studies"] == []


def test_studies_import_public_names_only():
    public = {(door, name) for door in DOORS for name in importlib.import_module(door).__all__}
    public |= {(door.rpartition(".")[0], door.rpartition(".")[2]) for door in DOORS}
    public |= {(door, "") for door in DOORS}
    used = foreign("studies")
    for who, door in [(who, module) for who, module, name in used if not name]:
        tree = ast.parse(modules("studies")[who].read_text(encoding="utf-8"))
        reached = {ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        used |= {(who, *one.rsplit(".", 1)) for one in reached if one.rpartition(".")[0] == door}
    assert {entry for entry in used if entry[1:] not in public} == set()


def test_a_chapter_imports_no_other_and_no_shared_folder_imports_a_chapter():
    """A study takes from its own folder, `physics`, `shell` and `letter`; no study imports another one."""
    programs_of = {name: set(chapter(name)) for name in CHAPTERS}
    assert all(programs_of.values())
    for name, targets in graph("studies").items():
        folder, own = [*name.split(".")[1:], "", ""][:2]
        for target in targets:
            other, study = [*target.split(".")[1:], "", ""][:2]
            assert other not in CHAPTERS or other == folder, f"{name} imports {target}"
            assert study not in programs_of.get(other, ()) or study == own, f"{name} imports {target}"


@pytest.mark.parametrize(
    ("statement", "unwanted"),
    [
        ("import beam", ("numpy", "scipy", *SLOW)),
        ("import contact", ("scipy.linalg", "scipy.optimize", *SLOW)),
        (
            "import beam.export, beam.space, studies.spring.modes",
            ("matplotlib", "meshio", "pyvista", "vtkmodules"),
        ),
        ("import studies.methods.peers; studies.methods.peers.missing_solvers()", ("heyoka", "sksundae")),
    ],
)
def test_slow_packages_are_imported_only_where_they_are_used(statement, unwanted):
    code = f"{statement}; import json, sys; print(json.dumps(sorted(sys.modules)))"
    command = [sys.executable, "-c", code]
    answer = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert not set(json.loads(answer.stdout)) & set(unwanted)


@pytest.mark.parametrize("door", DOORS)
def test_public_names_exist_and_type_checkers_see_them(door):
    module = importlib.import_module(door)
    assert len(module.__all__) == len(set(module.__all__)) > 0
    assert all(getattr(module, name) is not None for name in module.__all__)
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    told = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    told |= {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.alias)}
    assert set(module.__all__) <= told


def test_few_public_names_are_used_by_no_study_and_no_page():
    """What users meet nowhere need not be public; types of results may be."""
    pages = [path for path in (ROOT / "docs").rglob("*.md") if "api" not in path.parts]
    texts = [*(ROOT / "studies").rglob("*.py"), *pages, ROOT / "README.md"]
    words = set(re.findall(r"\w+", "".join(path.read_text(encoding="utf-8") for path in texts)))
    names = {name for door in DOORS for name in importlib.import_module(door).__all__}
    assert len(names - words) <= 15, sorted(names - words)


def test_one_version_everywhere():
    versions = {PROJECT["version"], *(importlib.import_module(package).__version__ for package in PACKAGES)}
    versions |= set(re.findall(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE))
    assert versions == set(re.findall(r"^## (\S+) \(", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE))


def test_hints_name_the_packages_of_the_extras():
    extras = PROJECT["optional-dependencies"]
    wanted = {re.split("[>=]", each)[0] for name in extras.keys() - {"test", "docs"} for each in extras[name]}
    text = "".join(path.read_text() for path in modules("studies").values())
    assert set(" ".join(re.findall(r'needs\(f?"[^"]*", "([^"]*)"\)', text)).split()) == wanted
    assert (
        needs("a film", "imageio-ffmpeg")
        == "a film needs imageio-ffmpeg: python -m pip install imageio-ffmpeg"
    )


def test_the_console_command_calls_itself_by_its_own_name(tmp_path):
    code = "import sys; sys.argv[0] = 'grazing-spring'; from studies.__main__ import main; "
    code += "sys.exit([main([word]) for word in ('--help', 'nonsense', 'report')] != [0, 2, 2])"
    command, env = [sys.executable, "-c", code], os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, check=True)
    assert "python -m studies" not in done.stdout + done.stderr and "run grazing-spring first" in done.stderr


@pytest.mark.slow
def test_the_source_archive_is_whole_and_its_wheel_runs_from_an_empty_folder(tmp_path):
    source, place, empty = (tmp_path / name for name in ("source", "environment", "empty"))
    made = "results", "build", "dist", "__pycache__", "*.egg-info", "made", "examples"
    left = shutil.ignore_patterns(".git", ".venv", *made)
    shutil.copytree(ROOT, source, ignore=left)
    tops = {*PACKAGES, *"tests docs .ci CHANGELOG.md CITATION.cff CONTRIBUTING.md constraints.txt".split()}
    here = {path.relative_to(source) for top in tops for path in [source / top, *(source / top).rglob("*")]}
    (source / "tests" / "kernel.nbi").touch()
    empty.mkdir()
    env = os.environ.copy()

    def run(*command: object, cwd: Path = empty) -> str:
        words = list(map(str, command))
        return subprocess.run(words, cwd=cwd, env=env, check=True, stdout=subprocess.PIPE, text=True).stdout

    run(sys.executable, "-m", "build", "--no-isolation", cwd=source)
    env.pop("PYTHONPATH", None)
    (archive,), (wheel,) = (source / "dist").glob("*.tar.gz"), (source / "dist").glob("*.whl")
    with tarfile.open(archive) as opened:
        shipped = {Path(*Path(name).parts[1:]) for name in opened.getnames()}
    assert {path for path in here if path.exists()} <= shipped
    assert not {path for path in shipped if path.suffix in (".nbi", ".nbc", ".pyc")}
    run(sys.executable, "-m", "venv", "--without-pip", place)
    python, program = place / "bin" / "python", place / "bin" / "grazing-spring"
    run(sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-index", wheel)
    (site,) = place.glob("lib/*/site-packages")
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib"))
    assert run(python, "-c", "import beam; print(beam.__file__)").startswith(str(site))
    assert run(program, "--version") == f"grazing-spring {PROJECT['version']}\n"
    run(program, "transitions", "--quick")
    manifest = json.loads((empty / "results" / "transitions" / "manifest.json").read_text())
    assert (manifest["status"], manifest["command"]) == ("done", "grazing-spring transitions --quick")
