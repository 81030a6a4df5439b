"""The scene reader under anything: a scene that survives being written and read again, or one sentence.

Hypothesis runs without a database and derives its examples from the test, so that every run is the same.
"""

from __future__ import annotations

import datetime
import json
import tomllib
import warnings
from collections.abc import Callable, Mapping
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from beam import SuspiciousValue
from studies.instruments.plausibility import suspicions
from studies.instruments.quantities import SceneError
from studies.instruments.scene import SECTIONS, Scene, keys, scene_of
from studies.instruments.scene_file import SCENES, dump_scene, read_scene, scene_from_text

KEYS = [key for key, _, _ in keys()]
NAMES = [key.partition(".")[2] for key in KEYS]
LETTER = (SCENES / "letter.toml").read_text()
WHOLE = dump_scene(Scene())
LINES = WHOLE.splitlines()
ASSIGNMENTS = [i for i, line in enumerate(LINES) if "=" in line and not line.startswith("#")]

fuzz = settings(
    max_examples=120, deadline=None, derandomize=True, database=None,
    suppress_health_check=[HealthCheck.too_slow],
)  # fmt: skip


def reads_or_complains(read: Callable[[], Scene]) -> None:
    """A scene that is the same after writing and reading, or a SceneError of one sentence."""
    try:
        scene = read()
    except SceneError as error:
        sentence = str(error)
        assert sentence and sentence.isprintable() and len(sentence) < 400
        return
    assert scene_from_text(dump_scene(scene)) == scene
    assert scene_of(scene.as_dict()).fingerprint() == scene.fingerprint()
    assert all(sentence.isprintable() and len(sentence) < 300 for sentence in suspicions(scene))


SCALARS = st.one_of(
    st.booleans(),
    st.integers(),
    st.integers(-(10**400), 10**400),
    st.floats(),
    st.floats(min_value=0.0, max_value=1e3),
    st.sampled_from([0.0, -0.0, 1e-320, 1.7e308, float("nan"), float("inf"), -float("inf")]),
    st.text(max_size=8),
    st.sampled_from(["cantilever", "hertz", "modal_data", "free", "none", "measured", "linear", "rayleigh"]),
    st.dates(min_value=datetime.date(1996, 1, 1), max_value=datetime.date(1996, 12, 31)),
    st.times(),
    st.datetimes(min_value=datetime.datetime(1996, 1, 1), max_value=datetime.datetime(1996, 12, 31)),
    st.none(),
    st.binary(max_size=3),
    st.complex_numbers(max_magnitude=10.0),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=2),
    max_leaves=6,
)


def toml(value: Any) -> str:
    """A value as TOML, as far as TOML has it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return str(value) if abs(value) < 10**300 or isinstance(value, float) else "9" * 400
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(k))} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, datetime.date | datetime.time):
        return value.isoformat()
    return json.dumps(str(value))


@given(st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=4))
@fuzz
def test_any_values_read_or_are_refused_in_one_sentence(changes: dict[str, object]) -> None:
    nested: dict[str, dict[str, object]] = {}
    for key, value in changes.items():
        section, _, name = key.partition(".")
        nested.setdefault(section, {})[name] = value
    reads_or_complains(lambda: scene_of(nested))


@given(st.dictionaries(st.sampled_from([*SECTIONS, "sprung"]) | st.text(max_size=6), VALUES, max_size=3))
@fuzz
def test_any_mapping_reads_or_is_refused_in_one_sentence(values: dict[str, object]) -> None:
    reads_or_complains(lambda: scene_of(values))


HEADERS = st.one_of(
    st.sampled_from([f"[{section}]" for section in SECTIONS]),
    st.sampled_from([f"[[{section}]]" for section in SECTIONS]),
    st.sampled_from([f"[{section}.deeper]" for section in SECTIONS]),
    st.text(max_size=8).map(lambda name: f"[{name}]"),
)
ENTRIES = st.builds(
    "{} = {}".format, st.sampled_from(NAMES) | st.sampled_from(KEYS) | st.text(max_size=6), VALUES.map(toml)
)


@given(st.lists(HEADERS | ENTRIES | st.text(max_size=12), max_size=8).map("\n".join))
@fuzz
def test_any_document_reads_or_is_refused_in_one_sentence(text: str) -> None:
    reads_or_complains(lambda: scene_from_text(text))


@given(st.integers(0, len(LETTER)), st.integers(0, 12), st.text(max_size=4))
@fuzz
def test_a_damaged_scene_reads_or_is_refused_in_one_sentence(place: int, length: int, inserted: str) -> None:
    damaged = LETTER[:place] + inserted + LETTER[place + length :]
    reads_or_complains(lambda: scene_from_text(damaged))


@given(
    st.sampled_from(ASSIGNMENTS),
    st.sampled_from(["drop", "double", "replace", "rename", "move", "cut"]),
    VALUES.map(toml),
    st.sampled_from(ASSIGNMENTS),
)
@fuzz
def test_a_changed_scene_reads_or_is_refused_in_one_sentence(
    place: int, change: str, value: str, other: int
) -> None:
    lines = list(LINES)
    name = lines[place].partition(" = ")[0]
    if change == "drop":
        del lines[place]
    elif change == "double":
        lines.insert(place, lines[place])
    elif change == "replace":
        lines[place] = f"{name} = {value}"
    elif change == "rename":
        lines[place] = lines[place].replace(name, name[::-1])
    elif change == "move":
        lines.insert(other, lines.pop(place))
    else:
        lines = lines[:place]
    reads_or_complains(lambda: scene_from_text("\n".join(lines)))


@given(st.sampled_from(KEYS) | st.text(max_size=10), VALUES.map(toml) | st.text(max_size=10))
@fuzz
def test_any_override_reads_or_is_refused_in_one_sentence(key: str, value: str) -> None:
    reads_or_complains(lambda: scene_from_text("", overrides=[f"{key}={value}"]))


@given(st.lists(st.text(max_size=12), max_size=3))
@fuzz
def test_any_text_after_set_reads_or_is_refused_in_one_sentence(overrides: list[str]) -> None:
    reads_or_complains(lambda: scene_from_text("", overrides=overrides))


@given(st.binary(max_size=60))
@fuzz
def test_any_bytes_read_or_are_refused_in_one_sentence(tmp_path_factory: Any, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_bytes(content)
    reads_or_complains(lambda: read_scene(path))


@given(st.text(max_size=20))
@fuzz
def test_any_name_of_a_scene_reads_or_is_refused_in_one_sentence(name: str) -> None:
    reads_or_complains(lambda: read_scene(name))


@given(
    st.sampled_from([key for key, kind, _ in keys() if kind is float]),
    st.sampled_from([1e-6, 1e-3, 1e3, 1e6, 1e9]),
)
@fuzz
def test_a_slip_of_a_unit_reads_or_is_refused_and_is_judged(key: str, factor: float) -> None:
    def read() -> Scene:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousValue)
            return read_scene("letter", [f"{key}={Scene()[key] * factor!r}"])

    reads_or_complains(read)


def test_the_fuzz_reaches_scenes_and_sentences() -> None:
    """What is drawn here is not all refused: the whole scene without one line reads, most of the time."""
    read = 0
    for place in ASSIGNMENTS:
        text = "\n".join(LINES[:place] + LINES[place + 1 :])
        assert tomllib.loads(text)
        read += scene_from_text(text) == Scene()
    assert read == len(ASSIGNMENTS)
