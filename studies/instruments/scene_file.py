"""Scenes as TOML: read one, change keys by hand, print one with comments.

    scene = read_scene("letter", ["drive.frequencies_hz=[22.2]"])     # a scene of ours by name, or any file
    print(dump_scene(scene))                                          # reads back as the same scene

Whatever the input, the outcome is a `Scene` or a `SceneError` of one sentence.
"""

from __future__ import annotations

import json
import tomllib
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from beam import SuspiciousValue
from studies.instruments.measured_modes import read_measured_modes
from studies.instruments.plausibility import suspicions
from studies.instruments.quantities import GIVEN, SceneError, shown, what_is_valid
from studies.instruments.scene import MODE_LISTS, SECTIONS, Scene, keys, scene_of, split

SCENES = Path(__file__).resolve().parent.parent / "scenes"
"""The folder of the scenes that come with the studies."""


def scene_path(name: str) -> Path:
    """The file that is meant: a path, or the bare name of a scene in `SCENES`."""
    path = Path(name)
    if path.suffix == "" and path.name == name and not path.exists():
        known = sorted(file.stem for file in SCENES.glob("*.toml"))
        if name not in known:
            choice = ", ".join(known)
            raise SceneError(f"there is no scene {shown(name)}: name a TOML file or one of {choice}")
        return SCENES / f"{name}.toml"
    return path


def read_scene(name: str | Path = "letter", overrides: Iterable[str] = ()) -> Scene:
    """The scene in a file, with `section.key=value` overrides in the order given (the last one wins).

    Warns
    -----
    SuspiciousValue
        Of values that are valid and can hardly be meant (``plausibility``).
    """
    path = scene_path(str(name))
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneError(f"the scene {shown(str(path))} cannot be read: it is not text in UTF-8") from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is no file name"
        raise SceneError(f"the scene {shown(str(path))} cannot be read: {reason}") from error
    scene = scene_from_text(text, name=str(path), overrides=overrides, folder=path.parent)
    for sentence in suspicions(scene):
        warnings.warn(sentence, SuspiciousValue, stacklevel=2)
    return scene


def scene_from_text(
    text: str, *, name: str = "scene", overrides: Iterable[str] = (), folder: Path | None = None
) -> Scene:
    """The scene in a TOML text; `folder` is where a `modal_data.file` named in it is looked for."""
    try:
        values = tomllib.loads(text.replace("\r\n", "\n"))
    except (ValueError, RecursionError) as error:
        nested = isinstance(error, RecursionError)
        reason = "it is nested too deeply" if nested else " ".join(str(error).split())[:200]
        raise SceneError(f"the scene {shown(name)} is not valid TOML: {reason}") from error
    _join_folder(values, folder)
    for override in overrides:
        key, value = parse_override(override)
        section, entry = split(key)
        table = values.setdefault(section, {})
        if isinstance(table, dict):  # anything else is refused below, with the sentence it deserves
            table[entry] = value
    return scene_of(_with_measured_modes(values), provenance=GIVEN)


def parse_override(text: str) -> tuple[str, Any]:
    """(dotted key, value) of `section.key=value`; the value is TOML, or else the bare text itself."""
    key, equals, value = text.partition("=")
    key, value = key.strip(), value.strip()
    if not equals or "." not in key:
        raise SceneError(f"--set needs section.key=value, for instance stop.gap_m=0.011, not {shown(text)}")
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    return key, parsed["value"] if set(parsed) == {"value"} else value


def _join_folder(values: dict[str, Any], folder: Path | None) -> None:
    data = values.get("modal_data")
    if folder is not None and isinstance(data, dict) and isinstance(data.get("file"), str) and data["file"]:
        data["file"] = str(folder / data["file"])


def _with_measured_modes(values: dict[str, Any]) -> dict[str, Any]:
    """`values` with the lists in place of the file that holds them: a scene depends on no other file."""
    data = values.get("modal_data")
    if not isinstance(data, dict) or not isinstance(data.get("file"), str) or not data["file"]:
        return values
    if any(data.get(name) for name in MODE_LISTS):
        raise SceneError("modal_data gives its modes twice, as lists and as a file: drop one of them")
    return {**values, "modal_data": {**data, "file": "", **read_measured_modes(Path(data["file"]))}}


def toml_value(value: object) -> str:
    """A value of a scene as TOML."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, tuple):
        return "[" + ", ".join(repr(item) for item in value) + "]"
    return repr(value)


def dump_scene(scene: Scene) -> str:
    """Every key as TOML, with meaning, unit, valid values, default and provenance as comments."""
    default, provenance = Scene(), scene.provenance()
    lines: list[str] = []
    section = ""
    for key, kind, entry in keys():
        here, name = split(key)
        if here != section:
            section = here
            title = " ".join((SECTIONS[section].__doc__ or "").split())
            lines += ["", f"# {title}", f"[{section}]"] if lines else [f"# {title}", f"[{section}]"]
        origin = entry.provenance
        if scene[key] != default[key]:
            origin += f"; here {provenance[key]}"
        lines += [
            f"# {entry.meaning}",
            f"#   {what_is_valid(kind, entry)}; default {toml_value(default[key])}, {origin}",
            f"{name} = {toml_value(scene[key])}",
        ]
    return "\n".join(lines) + "\n"
