"""Whether the tests see an error: `python tests/planted_errors.py --seed 1 --places 60`.

Plants one error at a time in a copy of the tree and runs the tests, which must pass without it, related ones
first, until one fails.  `planted.csv` in the folder `--out` keeps what was seen, and by which test; the same
command goes on from there.  An edited kernel takes a minute to compile: two terminals, with a seed, 30 places
and a folder each, take two hours at most.  With `--package studies` the places are in what studies compute.

Kinds: a sign flipped, a factor of two, a comparison turned, an index shifted, a term dropped.  Not places:
text, annotations and raised errors, which compute nothing; constants of modules, fields and arguments and
the bounds of loops, which are choices; arrays of one record.  A group beyond its `LIMITS` fails.
"""

import argparse
import ast
import csv
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "tests/equivalent_errors.csv"
FILES = {
    "contact/flight/*": "flight|crossing|polynomial|derivatives",
    "contact/touch/* contact/sensitivity/*": "contact_laws|delayed|derivatives|shooting|time_stepping",
    "contact/engine/*": "sampling|simulation|bouncing|digits|modes",
    "contact/collision contact/virtual_motion": "collision",
    "contact/orbits/*/* contact/orbits/s*": "shooting|families|derivatives|delayed|settling|clouds|path",
    "contact/maps/*": "nordmark|nonlinear|sampling|lyapunov|clouds|derivatives",
    "contact/one_mode/*": "single_mode|sampling|clouds",
    "studies/physics/*": "least_model|descriptions|calibration|two_parameters|noise|scene",
    "studies/experiment/*/* studies/experiment/trace": "",
    "studies/measurement/identify/*/* studies/measurement/identify/report": "",
    "studies/measurement/n*/* studies/measurement/identify/__main__": "",
    "studies/methods/[!p]*/* studies/methods/crossings": "",
    "studies/spring/*/* studies/spring/modes": "spring",
    "studies/shell/scene/* studies/shell/digits studies/shell/sweep": "scene|page|sweep",
}
"""Where the places are, and words in names of tests that run first there, beside the name of the folder."""
CHAPTERS = "studies/(experiment|measurement|methods|spring)/"
"""Places that only the tests with such a word in their name or text can see: no chapter imports another."""
DRAWN = "figure|film"
"""Files without places: a wrong picture is a matter for the eye."""
NOT_RUN = "bounded_calls|all_studies|explore|film|peers|pictures|tour"
"""Words in the names of tests that measure time, which other programs take too, or that draw."""
EVERY = "test_every_study"
"""Small forms of all studies: last, and for a place in one study only the small form of that study."""
LIMITS = 1200.0, 5400.0, 1200.0
"""Seconds for the related tests, for all others and for small forms; without an error half is enough."""
EQUIVALENT = {row["begins_with"]: row["why"] for row in csv.DictReader(TABLE.open(encoding="utf-8"))}
"""Errors that change nothing observable: the beginning of "file: line with the error", and why."""

TURNED: dict[type, Any] = {ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Eq: ast.NotEq}
TURNED |= {new: old for old, new in TURNED.items()}
JOINED = (ast.BinOp, ast.AugAssign)
FLIPPED = {ast.Add: ast.Sub, ast.Sub: ast.Add}
PRODUCT = (ast.Mult, ast.Div, ast.MatMult)
NO_PLACES = (ast.Raise, ast.JoinedStr, ast.AnnAssign, ast.arguments)


def errors(node: Any, above: Any, index: bool) -> Iterator[tuple[str, ast.AST]]:
    """(kind, what replaces the node) of each error that can be made at a node; `index`: it is one."""
    op = getattr(node, "op", None)
    if index and isinstance(node, ast.Constant) and isinstance(node.value, int):
        yield "index", ast.Constant(node.value - 1 if node.value else 1)
    elif index and isinstance(node, ast.Name | ast.Attribute | ast.BinOp):
        yield "index", ast.BinOp(node, ast.Sub(), ast.Constant(1))
    elif isinstance(node, JOINED) and any(isinstance(x, ast.List | ast.Tuple) for x in vars(node).values()):
        return  # lists and tuples
    elif isinstance(node, JOINED) and type(op) in FLIPPED:
        yield "sign", type(node)(**{**vars(node), "op": FLIPPED[type(op)]()})
        yield "term", node.left if isinstance(node, ast.BinOp) else ast.Pass()
    elif isinstance(node, ast.BinOp) and isinstance(op, PRODUCT):
        if not (isinstance(above, ast.BinOp) and isinstance(above.op, PRODUCT)):
            yield "factor", ast.BinOp(ast.Constant(2), ast.Mult(), node)
    elif isinstance(op, ast.USub):
        yield "index" if index else "sign", node.operand
    elif isinstance(node, ast.BoolOp):
        yield "term", ast.BoolOp(op, node.values[:-1]) if len(node.values) > 2 else node.values[0]
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in TURNED:
        turned = [TURNED[type(node.ops[0])](), *node.ops[1:]]
        yield "comparison", ast.Compare(node.left, turned, node.comparators)


def places(tree: ast.Module) -> Iterator[tuple[Any, ...]]:
    """(kind, holder, field, position, replacement) of each error that can be planted in a file."""
    nodes: list[Any] = list(ast.walk(tree))
    loops = [x for x in nodes if isinstance(x, ast.For | ast.comprehension)]
    loops = [x.target for x in loops if ast.unparse(x.iter).startswith(("range(", "enumerate("))]
    counts = {name.id for x in loops for name in ast.walk(x) if isinstance(name, ast.Name)}
    index, left_out = set(), set()
    for x in nodes:
        if isinstance(x, NO_PLACES) or (isinstance(x, ast.Assign) and x.col_offset == 0):
            left_out |= set(ast.walk(x))
        elif isinstance(x, ast.FunctionDef) and x.returns:
            left_out |= set(ast.walk(x.returns))
        elif isinstance(x, ast.Subscript) and not ast.unparse(x.value).endswith(("marks", "runs")):
            parts = x.slice.elts if isinstance(x.slice, ast.Tuple) else [x.slice]
            ends = [y for z in parts for y in ([z.lower, z.upper] if isinstance(z, ast.Slice) else [z])]
            index |= {y for y in ends if not isinstance(y, ast.Name) or y.id in counts}
        elif isinstance(x, ast.Call) and ast.unparse(x.func) == "range":
            index |= {y for y in x.args[:1] if len(x.args) > 1 or not isinstance(y, ast.Constant)}
    for x in nodes:
        for field, value in ast.iter_fields(x):
            for at, y in enumerate(value if isinstance(value, list) else [value]):
                if isinstance(y, ast.AST) and y not in left_out:
                    yield from ((kind, x, field, at, new) for kind, new in errors(y, x, y in index))


def planted(file: str, number: int) -> tuple[str, str, str]:
    """The line of a place, the line with the error, and the text of the file with it."""
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    right = ast.unparse(tree).splitlines()
    _, holder, field, at, new = list(places(tree))[number]
    if isinstance(slot := getattr(holder, field), list):
        slot[at] = new
    else:
        setattr(holder, field, new)
    wrong = ast.unparse(ast.fix_missing_locations(tree))
    a, b = next((a, b) for a, b in zip(right, wrong.splitlines(), strict=True) if a != b)
    same = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), len(b))
    start = max(len(a) - len(a.lstrip()), same - 40)
    return f"{file}: {a[start : start + 80]}", f"{file}: {b[start : start + 80]}", wrong


def chosen(package: str, seed: int, count: int, only: str) -> list[tuple[str, int, str]]:
    """(file, number, first tests) of a package's places: in turn from each kind and each part of `FILES`."""
    cells: dict[tuple[str, str], list[tuple[str, int, str]]] = {}
    for part, words in FILES.items():
        files = {each: set(ROOT.glob(f"{each}.py")) for each in part.split() if each.startswith(package)}
        assert all(files.values()), f"no file of {part}"
        for path in sorted(path for path in set().union(*files.values()) if not re.search(DRAWN, path.stem)):
            file = path.relative_to(ROOT).as_posix()
            own = path.relative_to(ROOT).with_suffix("").parts[2:3]  # the folder, or else the file
            first = "|".join(filter(None, [words, *own]))
            for number, (kind, *_) in enumerate(places(ast.parse(path.read_text(encoding="utf-8")))):
                if only in f"{kind}/{file}":
                    cells.setdefault((part, kind), []).append((file, number, first))
    order = random.Random(seed)
    columns = [order.sample(cell, len(cell)) for cell in order.sample(list(cells.values()), len(cells))]
    ranks = sorted((rank, i) for i, column in enumerate(columns) for rank in range(len(column)))
    return [columns[i][rank] for rank, i in ranks[:count]]


def failing(tree: Path, file: str, first: str) -> str:
    """The first test that fails in a copy of the tree with an error in this file."""
    env = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    folders = ["studies"] if file.startswith("studies") else ["contact", "studies"]
    tests = [test for folder in folders for test in sorted(tree.glob(f"tests/{folder}/test_*.py"))]
    tests = [test for test in tests if not re.search(NOT_RUN, test.stem)]
    if chapter := re.match(CHAPTERS, file):
        words = re.compile(rf"(?<![a-z])({first})")
        tests = [test for test in tests if words.search(test.stem + test.read_text(encoding="utf-8"))]
    for rank in range(3):
        group = [t for t in tests if rank == (0 if re.search(first, t.stem) else 1 + (t.stem == EVERY))]
        if not group:
            continue
        command = [sys.executable, "-m", "pytest", "-x", "-m", "not slow", "-p", "no:cacheprovider", *group]
        command += ["-k", first.replace("|", " or ")] if chapter and rank == 2 else []
        try:
            answer = subprocess.run(
                command, cwd=tree, env=env, capture_output=True, text=True, timeout=LIMITS[rank]
            )
        except subprocess.TimeoutExpired:
            return f"group {rank} takes too long"
        if answer.returncode not in (0, 5):  # 5: a file of long forms only
            found = re.search(r"^(?:FAILED|ERROR) (tests/.*?)(?: - |$)", answer.stdout, re.M)
            return found[1] if found else f"group {rank} ends with exit code {answer.returncode}"
    return "NOT SEEN"


def main() -> None:
    """Plant, run, write down; a line for each place."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--package", choices=("contact", "studies"), default="contact")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--places", type=int, default=60)
    parser.add_argument("--only", default="", help="places with this in KIND/FILE")
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "planted-errors")
    args = parser.parse_args()
    tree, table = args.out.resolve() / "tree", args.out / "planted.csv"
    ignore = shutil.ignore_patterns("__pycache__", ".*", "results")
    shutil.copytree(ROOT, tree, ignore=ignore, dirs_exist_ok=True)
    subprocess.run([sys.executable, "-m", "contact.warm_up"], cwd=tree, check=True)
    kernels = set(tree.glob("contact/__pycache__/kernels-*"))
    done = {(row[0], row[1]): row for row in csv.reader(table.open())} if table.exists() else {}
    wanted, begun, missed = chosen(args.package, args.seed, args.places, args.only), time.monotonic(), []
    for i, (file, number, first) in enumerate(wanted, 1):
        (before, after, text), start = planted(file, number), time.monotonic()
        if not (row := done.get((str(number), after))):
            (tree / file).write_text(text, encoding="utf-8")
            known = [why for line, why in EQUIVALENT.items() if after.startswith(line)]
            by = known[0] if known else failing(tree, file, first)
            shutil.copy2(ROOT / file, tree / file)
            for folder in set(tree.glob("contact/__pycache__/kernels-*")) - kernels:
                shutil.rmtree(folder)
            row = [str(number), after, before, by, f"{time.monotonic() - start:.0f} s"]
            with table.open("a", newline="") as stream:
                csv.writer(stream).writerow(row)
            left = (time.monotonic() - begun) / 60 * (len(wanted) / i - 1)
            print(f"{i}/{len(wanted)}, {left:.0f} min left: {'; '.join(row)}", flush=True)
        missed += [after] if row[3] == "NOT SEEN" else []
    print(f"{len(wanted)} places, {len(missed)} not seen", *missed, sep="\n")


if __name__ == "__main__":
    main()
