"""README and docs are true: their code runs, their links lead somewhere, their numbers are computed.

The long form runs each study in full; results that are stored already can be named by GRAZING_SPRING_RESULTS.
"""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import contact
from studies.experiment.transitions.__main__ import transitions
from studies.experiment.transitions.model import rows_at
from studies.physics.least_model import least_modes
from studies.pictures import costs_drawn
from studies.shell.programs import MAIN, in_words, run_times
from studies.shell.programs import names as programs
from studies.shell.scene import model_of, read_scene

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = [path for path in DOCS.rglob("*.md") if not {"made", "examples"} & set(path.relative_to(DOCS).parts)]
TEXTS = {str(path.relative_to(DOCS))[:-3]: path.read_text("utf-8") for path in PAGES}
TEXTS["README"] = (ROOT / "README.md").read_text("utf-8")
PLAIN = " ".join(" ".join(TEXTS.values()).split())
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
WITH_OUTPUT = re.compile(r"```python\n(.*?)```\n\n```text\n(.*?)```", re.DOTALL)
RUN_APART = {"guide/sweep", "methods/graze"}  # pages with programs of their own, each with its output
PROGRAMS = [(name, *pair) for name in sorted(RUN_APART) for pair in WITH_OUTPUT.findall(TEXTS[name])]


@pytest.mark.parametrize("name", sorted({p for p in TEXTS if BLOCK.search(TEXTS[p])} - RUN_APART))
def test_the_code_of_a_page_runs_and_prints_what_its_comments_promise(name, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    block = "".join(BLOCK.findall(TEXTS[name]))
    exec(compile(block, name, "exec"), {})
    assert capsys.readouterr().out.split("\n")[:-1] == re.findall(r"print\(.*\)  # (.*)", block)


@pytest.mark.parametrize("name, program, output", PROGRAMS, ids=[program[0] for program in PROGRAMS])
def test_a_program_on_its_own_prints_what_is_beside_it(name, program, output, tmp_path):
    assert sum(page == name for page, *_ in PROGRAMS) == len(BLOCK.findall(TEXTS[name]))
    for library in re.findall(r"^(?:import|from) (heyoka|sksundae)", program, flags=re.MULTILINE):
        pytest.importorskip(library)
    (tmp_path / "program.py").write_text(program)
    call, place = [sys.executable, str(tmp_path / "program.py")], os.environ | {"PYTHONPATH": str(ROOT)}
    run = subprocess.run(call, env=place, capture_output=True, text=True, timeout=300, check=True)
    assert run.stdout == output


def test_the_readme_is_short_and_every_link_leads_somewhere():
    prose = re.sub(r"```.*?```", "", TEXTS["README"], flags=re.DOTALL)
    assert len(TEXTS["README"].splitlines()) <= 125 and len(re.findall(r"(?<![\w.])\d[\d.]*", prose)) <= 80
    for name, text in TEXTS.items():
        for target in re.findall(r"\]\((?!https:)([^)#]*)", text):
            source = re.sub(r"\bexamples/index.rst", "gallery/GALLERY_HEADER.rst", target)
            source = re.sub(r"\bexamples/(\w+).rst", r"gallery/\1.py", source)
            assert ((ROOT if name == "README" else (DOCS / name).parent) / source).exists(), (name, target)


def test_words_with_a_meaning_of_their_own_are_in_the_glossary():
    """Words that the README and the docstring of `contact` introduce in italics; no term stands twice."""
    terms = re.findall(r"^(\w.*)(?=\n(?:\w.*\n)?  \S)", TEXTS["glossary"], flags=re.MULTILINE)
    texts = TEXTS["README"], contact.__doc__
    words = {word for text in texts for word in re.findall(r"(?<![*\w])\*([a-z]+)\*", text)}
    assert len(terms) > 60 and len(words) > 12 and len(set(terms)) == len(terms)
    assert [
        word for word in sorted(words) if not any(word in re.split("[ ,]+", term) for term in terms)
    ] == []


def test_every_study_named_exists_and_every_study_is_named():
    named = {word for text in TEXTS.values() for word in re.findall(r"python -m studies ([a-z_]+)", text)}
    assert named == set(programs()) - {MAIN}


def test_the_run_times_are_those_of_the_table():
    """`python -m studies --all` has measured it."""
    row = r"^\| .*`python -m studies(?: ([a-z_]+))?[^`]*` \|.*?\|? ?([\d.]+ (?:s|min)) \|$"
    known = {name: in_words(full) for name, (full, _) in run_times().items()}
    for text in (TEXTS["README"], TEXTS["guide/studies"]):
        written = {name or MAIN: words for name, words in re.findall(row, text, flags=re.MULTILINE)}
        assert len(written) > 3 and written.items() <= known.items()
    assert written == known and f"make study      # then {known[MAIN]}:" in TEXTS["README"]
    assert f"({in_words(sum(full for full, _ in run_times().values()))})" in TEXTS["guide/studies"]


def test_the_costs_are_those_of_the_table():
    costs = costs_drawn()
    for name, row in costs.items():
        pairs = [(row[f"microseconds_at_1e-{n}"], row[f"missed_at_1e-{n}"]) for n in (4, 8)]
        entries = [
            word for us, part in pairs for word in (time_in_words(us), f"{part:.0%}".replace("%", " %"))
        ]
        assert f"| {cells(name, *entries)} |".replace("| 0 % |", "| none |") in TEXTS["methods/costs"]
    fast, slow = (time_in_words(costs[name]["microseconds_at_1e-4"]) for name in ("exact", "SciPy DOP853"))
    assert f"takes {fast}" in PLAIN and f"SciPy (DOP853) takes {slow}" in PLAIN


def time_in_words(us: float) -> str:
    """A time, as the tables have it."""
    return f"{us:g} µs" if us < 1000.0 else f"{us / 1000.0:g} ms"


@pytest.mark.parametrize("frequency", [pytest.param(21.50, marks=pytest.mark.slow), 22.20])
def test_the_rows_of_the_tables_are_computed_values(frequency):
    scene, _ = least_modes(read_scene("letter"), transitions.needs)
    rows = rows_at(scene, frequency, model_of(scene)).rows
    periods = [f"p{row.m}" for row in rows if row.description != "two_parameters"]
    assert f"| {frequency:.2f} | p{rows[0].letter} | {' | '.join(periods)} |" in TEXTS["README"]
    ends = " | ".join(end_in_words(row.excess_down) for row in rows)
    assert f"| {frequency:.2f} | {periods[-1]} | {ends} |" in TEXTS["letter/transitions"]


def end_in_words(excess: float) -> str:
    """An excess, as the table of ends has it."""
    return re.sub(r"e-0", "e-", f"{excess:{'+' if excess > 0.0 else ''}.3e}")


def cells(*values: object) -> str:
    """A part of a row of a table."""
    return " | ".join(str(value) for value in values)


COMPUTED = "transitions hysteresis noise last_period effective_impact soft_wall breakdown identify".split()
COMPUTED += ["adequacy", "validation", "shape", "stability"]
"""Studies whose numbers stand in README and docs."""

CAUSES = {
    "Eq. (1)": "none: Eq. (1)",
    "beam": "none: beam",
    "T -0.02 ms": "the printed error",
    "finite rotations, gap 11.9 mm": "an effect of geometry",
    "T -0.02 ms, finite rotations": "both",
    "T -0.02 ms, finite rotations, gap x 1.25": "wider by a quarter",
    "recoil of 10 kg on 2 Hz, T on a base held still": "measured on a base held still",
    "finite rotations and anticlastic, legs of 24 mm": "stiffen as they curve across",
}
"""Change -> its words in the table of `last_period`."""


def facts_of(name: str, found: dict) -> Iterator[str]:
    """What the results of a study make of the sentences and tables of the docs."""
    rows = found["rows"]
    if name == "transitions":
        for f in dict.fromkeys(row["frequency_hz"] for row in rows):
            at = [row for row in rows if row["frequency_hz"] == f]
            yield cells(f"{f:.2f}", f"p{at[-1]['m']}", *(end_in_words(row["excess_down"]) for row in at))
        pairs = zip(rows[2::4], rows[3::4], strict=True)
        off = {a["frequency_hz"]: a["excess_down"] / b["excess_down"] for a, b in pairs}
        assert all(abs(off[f] - 1.0) < 0.1 for f in (21.5, 23.05, 23.4))
        factors = [max(off[f], 1.0 / off[f]) for f in (20.9, 22.2, 22.6)]
        yield "factors of {:.1f}, {:.1f} and {:.0f}".format(*factors)
        yield f"hysteresis of p3 too small by a factor of {factors[0]:.1f}"
    if name == "hysteresis":
        for key in list(found["causes"][0])[1:]:
            yield cells(*(f"{cause[key]:.2f}" for cause in found["causes"][:4]))
        by = {row["description"]: row for row in found["accuracy"]}
        for key, digits in {"map": 2, "single_mode": 2, "two_parameters": 2, "all_mode_kick": 4}.items():
            yield cells(*(f"{by[key][word]:.{digits}f}" for word in ("median", "worst")))
        yield f"{by['map']['folds']} folds of p3 to p10"
    if name == "noise":
        assert found["hidden"] == ["p6 at 22.60 Hz", "p8 at 23.05 Hz"]
        places = {(row["frequency_hz"], row["m"]) for row in rows}
        yield f"{found['settings']['scans']} scans up and 100 down at each of {len(places)} places"
        yield f"takes {-1e4 * found['change']:.1f}e-4 off the hysteresis"
        yield f"makes {100.0 * found['share']:.0f} % of the difference"
    if name == "last_period":
        assert found["first_merged"]["white"] == 10
        by = {row["cause"]: row["six_from"] for row in found["p10"]}
        for cause, words in CAUSES.items():
            yield f"{words} | {by[cause]:.4f}"
        yield f"{100.0 * by['beam']:.1f} % above grazing"
        for row in found["pairs"]:
            if row["pairs"] == "all" and row["excess"] in (0.0, 1e-3, 4e-3):
                limits = (f"{1e3 * row[key]:.3f}" for key in ("lowest_s", "highest_s"))
                yield cells(f"{row['excess']:g}", *limits)
    if name == "effective_impact":
        yield f"a restitution of {found['floors'][0]['restitution']:.2f} or more"
        taus = [row["restitution"] for row in found["on_settled_orbits"] if row["restitution"] is not None]
        yield f"is then {min(taus):.2f}-{max(taus):.2f}"
        yield f"delay is {1e3 * found['reference']['delay_s']:.2f} ms"
    if name == "soft_wall":
        beam = found["beam"]
        at = {
            key: f"{beam[key]:.0e}".replace("e-0", "e-") for key in beam if key.endswith(("excess", "from"))
        }
        yield f"above an excess of {at['square_root_from']}. At {at['half_excess']} the"
        yield f"at {at['unstable_excess']}, p1 of the beam"
    if name == "breakdown":
        yield f"a ball of {1e3 * found['found']['tip_mass_kg']:g} g does"
    if name == "adequacy":
        by = {(row["quantity"], row["frequency_hz"]): row for row in rows}
        for quantity, digits in (("restitution", 4), ("delay", 4)):
            row = by[quantity, 22.2]
            yield cells(*(f"{row[key]:.{digits}f}" for key in ("error", "error_one_less")))
        row = by["fold", 22.2]
        yield cells(*(f"{100.0 * row[key]:.1f} %" for key in ("error", "error_one_less")))
    if name == "validation":
        ends = "multipliers", "grazing amplitude", "a spring", "at grazing", "within 4 %", "within 3 %"
        for words, row in zip(ends, found["sources"], strict=True):
            yield cells(words, row["agrees"], row["differs"])
    if name == "stability":
        at = {row["case"]: row["measured"] for row in rows}
        short, long = "one short linear contact, h ω_c = {}", "{}, elastic Hertz, h / contact time = 1"
        yield " and by ".join(f"{at[short.format(x)]:.1f} at $h\\omega_c = {x}$" for x in (1.2, 1.8))
        yield f"a restitution of {at[long.format('trapezoidal rule')]:.2f}"
        yield f"full damping gave {at[long.format('gen.-α, ρ = 0')]:.2f}"
    if name == "shape":
        (factor,) = re.findall(r"factor of up to ([\d.]+)", " ".join(found["findings"]))
        yield f"differ by up to a factor of {factor}"
        for reading, radius in (("legs side by side", 0.009), ("folded", 0.0075)):
            (row,) = (
                row
                for row in found["springs"]
                if row["reading"] == reading and row["bend_radius_m"] == radius
                if abs(row["gap_m"] - 0.01188) < 1e-4 and abs(row["tip_mass_kg"] - 0.00683) < 1e-4
            )
            slower = [100.0 * (period / 40.8e-3 - 1.0) for period in row["effective_period_s"].values()]
            faster = 100.0 * row["kappa"] * (row["gap_m"] / row["length_m"]) ** 2
            span = f"{min(slower):+.2f} to {max(slower):+.2f} %"
            yield cells(f"{row['kappa']:+.3f}", f"{faster:+.3f} %", span, row["survive"])
    if name == "identify":
        digits = re.findall(r" to ([\d.]+\d)", " ".join(found["findings"][1:]))
        yield f"the letter's free period to {digits[0]} ms"
        yield f"the restitution to {digits[1]}"


@pytest.mark.slow
@pytest.mark.parametrize("name", COMPUTED)
def test_the_numbers_of_the_docs_are_computed(name, tmp_path):
    folder = Path(os.environ.get("GRAZING_SPRING_RESULTS", tmp_path))
    if not (folder / name / "summary.json").exists():
        command = [sys.executable, "-m", "studies", name, "--out", str(folder)]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    facts = list(facts_of(name, json.loads((folder / name / "summary.json").read_text("utf-8"))))
    assert facts and [fact for fact in facts if fact not in PLAIN] == []
