"""The report: what is stored becomes one page that needs nothing else, and a browser agrees.

The browser is driven over its debugging pipe (JSON messages that end with a zero byte, on descriptors 3 and
4), so that errors, requests and clicks are seen from inside. Without a browser these tests are skipped.
"""

from __future__ import annotations

import base64
import fcntl
import io
import json
import os
import re
import select
import shutil
import subprocess
import time
from contextlib import redirect_stderr, redirect_stdout, suppress
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import reduce
from html.parser import HTMLParser
from importlib import import_module
from importlib.util import find_spec
from operator import getitem
from pathlib import Path
from random import Random
from urllib.parse import unquote

import matplotlib.image
import numpy as np
import pytest

from beam.export import write_modes
from studies import ROOT, modes, report, transitions
from studies.instruments.figures import new_figure
from studies.instruments.record import Record
from studies.instruments.report import pictures, section, turnable
from studies.instruments.report.declared import DECLARED, WITHOUT_SUMMARY
from studies.instruments.report.digits import fixed, period, scaled, significant, span, trimmed
from studies.instruments.report.entry import NOT_RUN, UNREADABLE, found_on
from studies.instruments.report.markup import Column, Table, prose, sentence
from studies.instruments.report.page import Contents, html
from studies.instruments.report.pictures import Picture
from studies.instruments.report.stored import read, read_all
from studies.instruments.report.writing import entries, write_report
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_of_scene import modes_of
from studies.published import PERIODS

PROGRAMS = {"report", "export"}
"""Programs that are no studies."""

QUICK_FORMS = (
    "hysteresis",
    "effective_impact",
    "soft_wall",
    "time_trace",
    "breakdown",
    "claims",
    "sensitivity",
    "chart",
    "attractors",
    "modes",
    "motion",
    "spring_shape",
    "benchmarks",
)
"""Studies whose small form takes seconds."""


# what is read


@dataclass
class Page(HTMLParser):
    """The elements of a page."""

    ids: list[str] = field(default_factory=list)
    images: list[dict[str, str | None]] = field(default_factory=list)
    addresses: list[str] = field(default_factory=list)
    scripts: list[str] = field(default_factory=list)
    metas: list[dict[str, str | None]] = field(default_factory=list)
    words: list[str] = field(default_factory=list)
    inside: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__(convert_charrefs=True)

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.ids += [found["id"]] if "id" in found else []
        self.images += [found] if tag == "img" else []
        self.metas += [found] if tag == "meta" else []
        self.addresses += [found[name] for name in ("src", "href", "srcset", "action") if name in found]
        if tag not in ("img", "meta", "link", "br", "wbr"):
            self.inside.append(tag)
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag):
        assert self.inside.pop() == tag, f"{tag} closes what is not open"

    def handle_data(self, data):
        if self.inside and self.inside[-1] == "script":
            self.scripts[-1] += data
        elif self.inside and self.inside[-1] != "style":
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def parsed(path: Path) -> Page:
    page = Page()
    page.feed(path.read_text(encoding="utf-8"))
    page.close()
    assert not page.inside
    return page


def letter_rows(path: Path) -> dict[str, str]:
    """Verdict by what the letter says, from the table of the page."""
    text = path.read_text(encoding="utf-8")
    table = text[text.index('<table class="points">') :]
    rows = re.findall(r"<tr>(.*?)</tr>", table[: table.index("</table>")], flags=re.DOTALL)[1:]
    found = {}
    for row in rows:
        says = re.search(r'<td class="says">(.*?)(<span class="why"|</td>)', row).group(1)
        found[re.sub(r"<[^>]+>", "", says).replace("\N{NO-BREAK SPACE}", " ")] = re.search(
            r'class="verdict [\w-]+">([\w ]+)<', row
        ).group(1)
    return found


def stored_transitions(results: Path, periods=None, **settings) -> Record:
    """Results of the main job as it stores them, with periods of our choice."""
    scene = read_scene("letter", settings.pop("overrides", []))
    record = Record(
        study="transitions",
        folder=results / "transitions",
        scene=scene,
        command="python -m studies",
        settings={"quick": False, **settings},
    )
    rows = []
    for frequency, letter in PERIODS.items():
        m = (periods or {}).get(frequency, letter)
        row = {"frequency_hz": frequency, "letter": letter}
        for name in ("map", "single_mode", "beam"):
            row |= {name: m, f"excess_down_{name}": -8.53e-4, f"ends_by_{name}": "fold"}
            row[f"born_{name}"] = {"0.01": m}
        rows.append(row)
    figure, axes = new_figure()
    axes.plot([0, 1], [0, 1])
    record.write_figure(figure, "orbit_diagram")
    record.close("done", {"rows": rows, "closing": ["figure: nowhere", "p3 at 20.90 Hz, 6.6e-05 <b>"]})
    return record


def stored_modes(results: Path) -> None:
    """The modes of the spring, stored as their study does, without its films."""
    scene = read_scene("letter", ["modes.count=3"])
    found = modes_of(scene)
    table = modes.table_of(scene, found)
    record = Record(study="modes", folder=results / "modes", scene=scene, command="python -m studies.modes")
    write_modes(record.folder / "modes.vtu", found, decay_rates=table["decay_rate_per_s"], ball_radius=0.0025)
    record.files.append("modes.vtu")
    figure, axes = new_figure()
    axes.plot(found.frequencies_hz)
    record.write_figure(figure, "modes")
    names = (
        "frequency_hz",
        "exact_hz",
        "decay_rate_per_s",
        "tip_value_kg^-1/2",
        "participation_kg^1/2",
        "coupled",
    )
    keys = ("frequencies_hz", "exact_hz", "decay_rates", "tip_values", "participation", "coupled")
    record.close("done", {key: table[name] for key, name in zip(keys, names, strict=True)})


@dataclass(frozen=True)
class MainJob:
    """A folder of results after the main job has run in it, and what that printed."""

    folder: Path
    out: str
    err: str


@pytest.fixture(scope="module")
def main_job(tmp_path_factory):
    """The small form of the main job in a folder that already holds the modes."""
    folder = tmp_path_factory.mktemp("results")
    stored_modes(folder)
    arguments = ["--json", "--quick", "--set", "drive.frequencies_hz=[22.2]", "--set", "scan.points=3"]
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        assert transitions.main([*arguments, "--out", str(folder)], module="studies") == 0
    return MainJob(folder, out.getvalue(), err.getvalue())


@pytest.fixture(scope="module")
def results(main_job):
    return main_job.folder


# the page


def check(path: Path) -> Page:
    """What holds for every page: whole, by itself, and free of requests."""
    page = parsed(path)
    assert len(page.ids) == len(set(page.ids))
    for image in page.images:
        assert "alt" in image and image["src"].startswith("data:")
    assert all(
        image["alt"] for image in page.images[:-1]
    )  # the last one is the empty stage of enlarged figures
    for address in page.addresses:
        if address.startswith("#"):
            assert address[1:] in page.ids
        elif not address.startswith("data:"):
            assert ":" not in address.split("/")[0] and not address.startswith("/")
            assert (path.parent / unquote(address)).exists(), address
    active = [text for text in page.scripts if "{" in text]
    assert len(active) == 1
    assert not re.search(r"\b(fetch|XMLHttpRequest|WebSocket|import|EventSource|sendBeacon)\b", active[0])
    (policy,) = [
        meta["content"] for meta in page.metas if meta.get("http-equiv") == "Content-Security-Policy"
    ]
    assert "default-src 'none'" in policy and "http" not in policy
    return page


def test_the_main_job_ends_with_a_page_that_stands_by_itself(results):
    path = results / "report" / "index.html"
    page = check(path)
    assert len(page.images) >= 4 and {"study-transitions", "study-modes", "letter", "answers"} <= set(
        page.ids
    )
    said = letter_rows(path)
    assert said["At 22.20 Hz p1 goes over into p5."] == "agrees"
    assert said["At 20.90 Hz p1 goes over into p3."] == UNREADABLE  # this run was at 22.20 Hz only
    assert said["Period T of the freely swinging beam."] == "fitted"
    assert said["The spring is U shaped to suppress torsional modes."] == NOT_RUN
    assert "python -m studies.hysteresis" in page.text and "Made with --quick" in page.text


def test_the_main_job_prints_one_json_object_and_says_where_the_report_is(main_job):
    assert json.loads(main_job.out)["study"] == "transitions"
    assert f"report: {main_job.folder / 'report' / 'index.html'}" in main_job.err


def test_verdicts_follow_what_is_stored(tmp_path):
    wanted = {}
    for name, beam, verdict in (("same", 10, "agrees"), ("next", 11, "differs"), ("none", 0, "differs")):
        stored_transitions(tmp_path / name, {23.40: beam})
        path = write_report(tmp_path / name).path
        wanted[verdict] = letter_rows(path)["At 23.40 Hz p1 goes over into p10."]
        assert wanted[verdict] == verdict
        text = check(path).text
        # the edge that explains p11 is computed from the free period, and named only where p11 was found
        assert ("23.343 Hz" in text and "40.70 ms" in text) == (beam == 11)


def test_text_from_results_is_escaped_and_set(tmp_path):
    stored_transitions(tmp_path)
    text = write_report(tmp_path).path.read_text(encoding="utf-8")
    assert "<i>p</i><sub>3</sub> at 20.90 Hz, 6.6 × 10<sup>−5</sup> &lt;b&gt;" in text.replace(
        "\N{NO-BREAK SPACE}", " "
    )
    assert "figure: nowhere" not in text


def test_broken_results_are_sentences_not_failures(tmp_path, capsys):
    stored_transitions(tmp_path)
    (tmp_path / "transitions" / "orbit_diagram.pdf").unlink()
    (tmp_path / "transitions" / "orbit_diagram.png").write_bytes(b"not a picture")
    for study, text in {
        "hysteresis": "{",
        "claims": "[1]",
        "soft_wall": '{"schema": 1}',
        "chart": "\x00",
    }.items():
        (tmp_path / study).mkdir()
        (tmp_path / study / "summary.json").write_text(text)
    (tmp_path / "hysteresis" / "manifest.json").write_text(
        '{"schema": 1, "files": 3, "parameters": 4, "git": 5}'
    )
    (tmp_path / "breakdown").mkdir()
    (tmp_path / "breakdown" / "manifest.json").write_text('{"schema": 99, "settings": [], "versions": 3}')
    (tmp_path / "own_idea").mkdir()
    shutil.copy(ROOT / "README.md", tmp_path / "own_idea" / "drawn.png")
    (tmp_path / "empty").mkdir()
    assert report.main(["--out", str(tmp_path)]) == 0
    err = capsys.readouterr().err
    assert "Traceback" not in err
    text = check(tmp_path / "report" / "index.html").text
    for sentence_wanted in (
        "transitions: the manifest names files that are not there: orbit_diagram.pdf.",
        "transitions/orbit_diagram.png is not a picture.",
        "Hysteresis/summary.json cannot be read: it is not JSON.",
        "Claims/summary.json holds no JSON object.",
        "The stored summary of soft_wall does not hold its table.",
        "has the layout 99, this report knows 1.",
        "own_idea/drawn.png is not a picture.",
    ):
        assert sentence_wanted.lower() in text.lower(), sentence_wanted
    assert letter_rows(tmp_path / "report" / "index.html")["At 20.90 Hz p1 goes over into p3."] == "agrees"


def places_in(value, place=()):
    """Every place in nested objects and lists, as the keys that lead to it."""
    entries = (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    )
    for key, item in entries:
        yield (*place, key)
        yield from places_in(item, (*place, key))


def test_no_damage_to_a_single_value_costs_the_page(results):
    """Values of stored objects removed or replaced at random places, forty pages in all."""
    sound = read_all(results)
    places = {
        (study, name): list(places_in(getattr(sound[study], name)))
        for study in sound
        for name in ("summary", "manifest")
    }
    random = Random(7)
    junk = [None, "x", -1, 1.5, [], {}, [1], {"a": 1}, True]
    for _ in range(40):
        damaged = {}
        for study, stored in sound.items():
            parts = {}
            for name in ("summary", "manifest"):
                parts[name] = deepcopy(getattr(stored, name))
                for *way, last in random.sample(places[study, name], 3):
                    with suppress(KeyError, IndexError, TypeError):  # a way that was cut off before
                        holder = reduce(getitem, way, parts[name])
                        holder[last] = random.choice(junk)
                        if random.random() < 0.3:
                            del holder[last]
            damaged[study] = replace(stored, **parts)
        contents = Contents(entries=entries(list(damaged)), stored=damaged, missing=[], made="now")
        text = html(contents, results / "report")
        assert text.endswith("</html>\n") and 'id="study-modes"' in text


def test_without_results_one_sentence_says_what_to_run(tmp_path, capsys):
    for folder in (tmp_path, tmp_path / "absent"):
        assert report.main(["--out", str(folder), "--json"]) == 2
        printed = capsys.readouterr()
        assert "run `python -m studies` first" in printed.err and len(printed.err.splitlines()) == 1
        assert json.loads(printed.out)["status"] == "refused"
    assert not (tmp_path / "report").exists()
    assert report.main(["--nonsense"]) == 2


def test_json_names_the_page_the_studies_and_what_is_missing(results, capsys):
    assert report.main(["--out", str(results), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert Path(told["page"]).stat().st_size == told["bytes"]
    assert told["studies"] == ["transitions", "modes"] and "hysteresis" in told["missing"]
    assert told["faults"] == [] and any("--quick" in sentence for sentence in told["warnings"])


def test_studies_of_different_scenes_are_told_apart(tmp_path):
    stored_transitions(tmp_path)
    assert not [w for w in write_report(tmp_path).warnings if "scene" in w]
    other = Record(
        study="hysteresis",
        folder=tmp_path / "hysteresis",
        scene=read_scene("letter", ["stop.gap_m=0.012"]),
        command="python -m studies.hysteresis",
    )
    other.close("done", {})
    warned = write_report(tmp_path).warnings
    assert any("stop.gap_m 0.012 instead of 0.0106993324" in sentence for sentence in warned)
    # what a study's accuracy asks for is no difference of scene
    manifest = tmp_path / "hysteresis" / "manifest.json"
    values = json.loads(manifest.read_text())
    values["parameters"]["stop"]["gap_m"] = 0.0106993324
    values["parameters"]["modes"]["count"], values["provenance"]["modes.count"] = 15, "needed"
    values["git"] = {"commit": "0" * 40, "dirty": True}
    manifest.write_text(json.dumps(values))
    warned = write_report(tmp_path).warnings
    assert not any("another scene" in sentence for sentence in warned)
    assert any("different commits" in sentence for sentence in warned)


def test_a_page_that_would_grow_too_large_links_its_pictures(tmp_path):
    stored_transitions(tmp_path)
    size = (tmp_path / "transitions" / "orbit_diagram.png").stat().st_size
    space = section.Space(folder=tmp_path / "report", left=size - 1)
    drawn = section.image(tmp_path / "transitions" / "orbit_diagram.png", "points", space)
    assert "data:" not in drawn and "../transitions/orbit_diagram.png" in drawn
    space.left = size
    assert "data:image/png" in section.image(tmp_path / "transitions" / "orbit_diagram.png", "points", space)
    assert space.left == 0


# the declarations


def test_every_study_is_declared_once_and_every_declaration_is_a_study():
    there = {
        path.stem
        for path in (ROOT / "studies").glob("[a-z]*.py")
        if "def main(" in path.read_text(encoding="utf-8")
    }
    declared = [entry.study for entry in DECLARED]
    assert len(declared) == len(set(declared))
    assert there - PROGRAMS <= set(declared)
    assert set(declared) - set(WITHOUT_SUMMARY) <= there
    places = [point.says for entry in DECLARED for point in entry.points]
    assert len(places) == len(set(places)) > 25


@pytest.mark.slow
@pytest.mark.parametrize("study", QUICK_FORMS)
def test_declarations_fit_what_the_study_stores(study, tmp_path):
    """Every table, figure and point that is declared for a study is found in what it stores."""
    assert import_module(f"studies.{study}").main(["--quick", "--out", str(tmp_path)]) == 0
    (entry,) = [entry for entry in DECLARED if entry.study == study]
    stored = read(tmp_path / study)
    assert not stored.faults
    for table in entry.tables(stored.summary):
        assert table.columns[0].values and "<tbody><tr>" in table.html()
    assert all(isinstance(line, str) and line for line in entry.findings(stored.summary))
    for point in entry.points:
        assert found_on(point, stored, study).verdict not in (NOT_RUN, UNREADABLE), point.says
    shown = [path.stem for path in stored.pictures() if path.suffix == ".png"]
    assert shown and set(shown) <= set(entry.captions)


@pytest.mark.parametrize(
    ("written", "wanted"),
    [
        (significant(3)(-0.00062813), "−6.28 × 10<sup>−4</sup>"),
        (significant(3)(0.99999), "1.00"),
        (significant(2)(99999.0), "1.0 × 10<sup>5</sup>"),
        (significant(2)(1e-7), "1.0 × 10<sup>−7</sup>"),
        (significant(1)(1e6), "10<sup>6</sup>"),
        (significant(3)(0), "0"),
        (significant(3)(float("nan")), "–"),
        (fixed(2)(-22.6), "−22.60"),
        (fixed(2)(None), "–"),
        (scaled(1e4, 2)(-0.00062813), "−6.28"),
        (trimmed(5)(8500.0), "8500"),
        (trimmed(5)(0.1), "0.1"),
        (trimmed(5)(0.00069683709), "6.9684 × 10<sup>−4</sup>"),
        (trimmed(5)(1e9), "10<sup>9</sup>"),
        (span(0.2, 0.2, fixed(1)), "0.2"),
        (period(0), "none"),
        (period(11), "<i>p</i><sub>11</sub>"),
        (
            prose("F_m/F_g - 1 = -6.6e-05"),
            "<i>F</i><sub>m</sub>/<i>F</i><sub>g</sub> − 1 = −6.6 × 10<sup>−5</sup>",
        ),
        (prose("h^(3/2), K^-1/2, 1e+04"), "h<sup>3/2</sup>, K<sup>−1/2</sup>, 10<sup>4</sup>"),
        (
            prose("p3 to p_10; effective_impact"),
            "<i>p</i><sub>3</sub> to <i>p</i><sub>10</sub>; effective_impact",
        ),
        (prose("62 us of us <i>"), "62 µs of us &lt;i&gt;"),
        (prose("--quick of 2026-11-21"), "--quick of 2026-11-21"),
        (sentence("tau is small"), "Tau is small."),
        (sentence("p_3 is born?"), "<i>p</i><sub>3</sub> is born?"),
    ],
)
def test_numbers_and_prose_are_set_as_mathematics(written, wanted):
    assert written.replace("\N{NO-BREAK SPACE}", " ") == wanted


def test_columns_of_unequal_length_are_refused():
    columns = [Column(head="a", values=[1], write=str), Column(head="b", values=[1, 2], write=str)]
    with pytest.raises(ValueError, match="equal lengths"):
        Table(caption="c", columns=columns).html()


# 3-D modes


def test_without_the_extra_a_sentence_names_it(results, monkeypatch):
    monkeypatch.setattr(turnable, "find_spec", lambda name: None)
    path = write_report(results).path
    assert "the extra web" in check(path).text.replace("`", "").lower()
    assert '<div class="turn"' not in path.read_text(encoding="utf-8")


@pytest.mark.skipif(find_spec("trame_vtk") is None, reason="needs the extra web")
def test_a_mesh_that_cannot_be_read_is_a_sentence(tmp_path):
    broken = tmp_path / "modes.vtu"
    broken.write_text("<VTKFile>")
    assert turnable.turnable(broken) == turnable.FAILED


# the browser

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--window-size=1280,900",
)
PATIENCE = 30.0
"""Seconds for an answer of the browser; the first one takes one or two."""


class Browser:
    """Chromium without a window, listened to from inside."""

    def __init__(self, folder: Path) -> None:
        low, self._write = os.pipe()
        self._read, also_low = os.pipe()
        theirs = tuple(fcntl.fcntl(end, fcntl.F_DUPFD, 20) for end in (low, also_low))  # clear of 3 and 4
        start = 'exec "$@" 3<&{0} 4>&{1} {0}<&- {1}>&-'.format(*theirs)
        command = [
            str(CHROMIUM),
            *FLAGS,
            f"--user-data-dir={folder}",
            "--remote-debugging-pipe",
            "about:blank",
        ]
        self._process = subprocess.Popen(
            ["bash", "-c", start, "bash", *command],
            pass_fds=theirs,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for end in (low, also_low, *theirs):
            os.close(end)
        self._left, self._number, self._session = b"", 0, None
        self.events: list[dict] = []
        (target, *_) = [t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page"]
        attached = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Network", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        # a sandboxed frame has a process of its own: it waits until it is listened to as well
        self.call("Target.setAutoAttach", autoAttach=True, waitForDebuggerOnStart=True, flatten=True)

    def _message(self, patience: float) -> dict:
        end = time.monotonic() + patience
        while b"\0" not in self._left:
            if not select.select([self._read], [], [], max(0.0, end - time.monotonic()))[0]:
                raise TimeoutError("the browser says nothing")
            piece = os.read(self._read, 1 << 20)
            if not piece:
                raise EOFError("the browser has ended")
            self._left += piece
        text, self._left = self._left.split(b"\0", 1)
        message = json.loads(text)
        if message.get("method") == "Target.attachedToTarget":
            session = message["params"]["sessionId"]
            for method in (
                "Network.enable",
                "Runtime.enable",
                "Log.enable",
                "Runtime.runIfWaitingForDebugger",
            ):
                self._send(method, {}, session)
        return message

    def _send(self, method: str, parameters: dict, session: str | None) -> int:
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        return self._number

    def call(self, method: str, **parameters):
        number = self._send(method, parameters, self._session)
        while True:
            answer = self._message(PATIENCE)
            if answer.get("id") == number:
                assert "error" not in answer, answer
                return answer["result"]
            self.events.append(answer)

    def open(self, path: Path) -> None:
        self.events.clear()
        self.call("Page.navigate", url=path.resolve().as_uri())
        while not any(event.get("method") == "Page.loadEventFired" for event in self.events):
            self.events.append(self._message(PATIENCE))

    def run(self, expression: str):
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def until(self, expression: str) -> None:
        end = time.monotonic() + PATIENCE
        while not self.run(expression):
            assert time.monotonic() < end, expression
            time.sleep(0.05)

    def press(self, key: str) -> None:
        for kind in ("keyDown", "keyUp"):
            code = {"Escape": 27}.get(key, 0)
            text = {} if code or kind == "keyUp" else {"text": key}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code, **text)

    def picture(self, x: float, y: float, width: float, height: float) -> np.ndarray:
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        shot = self.call("Page.captureScreenshot", format="png", clip=clip, captureBeyondViewport=True)
        return matplotlib.image.imread(io.BytesIO(base64.b64decode(shot["data"])))[..., :3]

    def complaints(self) -> list:
        """Exceptions, and whatever the console shows as an error."""
        thrown = [e["params"] for e in self.events if e.get("method") == "Runtime.exceptionThrown"]
        logged = [e["params"]["entry"] for e in self.events if e.get("method") == "Log.entryAdded"]
        called = [e["params"] for e in self.events if e.get("method") == "Runtime.consoleAPICalled"]
        return (
            thrown
            + [entry for entry in logged if entry["level"] == "error"]
            + [entry for entry in called if entry["type"] in ("error", "assert")]
        )

    def outside(self, page: Path) -> list[str]:
        """Addresses that were asked for, but for the page itself and what is in it."""
        asked = [
            e["params"]["request"]["url"]
            for e in self.events
            if e.get("method") == "Network.requestWillBeSent"
        ]
        assert page.resolve().as_uri() in asked
        return [
            url
            for url in asked
            if not url.startswith(("data:", "blob:", "about:")) and url != page.resolve().as_uri()
        ]

    def close(self) -> None:
        try:
            os.write(self._write, b'{"id": 0, "method": "Browser.close"}\0')
            self._process.wait(10)
        except (OSError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait(10)
        os.close(self._write)
        os.close(self._read)


@pytest.fixture
def browser(tmp_path):
    if CHROMIUM is None:
        pytest.skip("needs chromium on the path")
    found = Browser(tmp_path / "profile")
    yield found
    found.close()


def test_in_a_browser_the_page_loads_nothing_enlarges_figures_and_fits(browser, results):
    path = write_report(results).path
    browser.open(path)
    assert browser.run("document.querySelectorAll('main img').length") >= 4
    assert browser.run(
        "[...document.querySelectorAll('main img')].every(i => i.complete && i.naturalWidth > 0)"
    )
    assert browser.run("document.documentElement.scrollWidth <= innerWidth")
    # a figure opens enlarged, grows and shrinks by keys, and Esc closes it
    browser.run("document.querySelector('#study-transitions button.zoom').click()")
    browser.until(
        "document.querySelector('dialog').open && document.querySelector('dialog img').naturalWidth > 9"
    )
    browser.until("document.querySelector('dialog img').style.width !== ''")
    width = "parseFloat(document.querySelector('dialog img').style.width)"
    fitted = browser.run(width)
    assert fitted <= browser.run("innerWidth")
    browser.press("+")
    assert browser.run(width) == pytest.approx(1.4 * fitted, rel=1e-3)
    browser.press("0")
    assert browser.run(width) == pytest.approx(fitted, rel=1e-3)
    browser.press("Escape")
    browser.until("!document.querySelector('dialog').open")
    # a narrow window scrolls tables, not the page
    browser.call(
        "Emulation.setDeviceMetricsOverride", width=420, height=900, deviceScaleFactor=1, mobile=True
    )
    browser.open(path)
    assert browser.run("document.documentElement.scrollWidth") <= 420
    assert browser.run("document.querySelector('nav details').open") is False
    assert browser.complaints() == [] and browser.outside(path) == []
    # and it prints
    pdf = base64.b64decode(browser.call("Page.printToPDF", preferCSSPageSize=True)["data"])
    assert pdf.startswith(b"%PDF") and pdf.count(b"/Type /Page\n") + pdf.count(b"/Type /Page ") >= 3


def test_the_policy_of_the_page_stops_a_request(browser, results, tmp_path):
    """The check above would see a request: one that is planted is refused, and complained of."""
    text = write_report(results).path.read_text(encoding="utf-8")
    planted = tmp_path / "planted.html"
    planted.write_text(text.replace("</main>", '<img src="https://example.invalid/x.png" alt="x"></main>'))
    browser.open(planted)
    browser.until("document.querySelector('main > img').complete")
    assert any("Content Security Policy" in str(entry) for entry in browser.complaints())


@pytest.mark.skipif(find_spec("trame_vtk") is None, reason="needs the extra web")
def test_in_a_browser_a_mode_can_be_turned_and_loads_nothing(browser, results):
    assert write_report(results).turnable
    path = results / "report" / "index.html"
    browser.open(path)
    browser.run("document.querySelector('.turn button').click()")
    browser.run("document.querySelector('.turn').scrollIntoView({behavior: 'instant'})")
    place = (
        "(() => { const r = document.querySelector('.turn iframe').getBoundingClientRect(); return [r.x + "
        "scrollX, r.y + scrollY, r.width, r.height, r.y]; })()"
    )

    def brass() -> np.ndarray:
        """Where the frame shows the colour of brass."""
        x, y, width, height, _top = browser.run(place)
        red, green, blue = np.moveaxis(browser.picture(x, y, width, height), -1, 0)
        return (red > green + 0.05) & (green > blue + 0.1) & (red > 0.3)

    end = time.monotonic() + PATIENCE
    while not (first := brass()).sum() > 1000:
        assert time.monotonic() < end, "the mode does not appear"
        time.sleep(0.2)
    x, _y, width, height, top = browser.run(place)
    for kind, across in (
        ("mousePressed", 0.5),
        ("mouseMoved", 0.6),
        ("mouseMoved", 0.8),
        ("mouseReleased", 0.8),
    ):
        browser.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x + across * width,
            y=top + 0.6 * height,
            button="left",
            buttons=0 if kind == "mouseReleased" else 1,
            clickCount=1,
        )
    while not (first ^ brass()).sum() > 1000:
        assert time.monotonic() < end, "the mode does not turn"
        time.sleep(0.2)
    assert browser.complaints() == [] and browser.outside(path) == []


def test_sizes_are_read_from_the_files(tmp_path):
    figure, _axes = new_figure(width=0.0508, height=0.0254)
    figure.savefig(tmp_path / "a.png", dpi=100)
    found = pictures.read(tmp_path / "a.png")
    assert isinstance(found, Picture)
    assert (found.width, found.height) == (round(200 * 0.62), round(100 * 0.62))
    for content in (b"", b"GIF89a", pictures.PNG + bytes(30)):
        (tmp_path / "b.png").write_bytes(content)
        with pytest.raises(pictures.NoPicture):
            pictures.read(tmp_path / "b.png")
