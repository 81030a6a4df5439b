"""A scene as values: sections of plain numbers, from TOML, changed by dotted keys, printed with comments.

    scene = scene_from_text(text, overrides=["stop.gap_m=0.011"])
    thinner = scene.replace({"spring.thickness_m": 0.00060})
    scene.spring.thickness_m, scene["spring.thickness_m"]
    print(scene.dump())                                    # reads back as the same scene

Values are of the right type here; `studies.shell.scene` makes spring, law and drive of them and so checks
ranges.
"""

from __future__ import annotations

import dataclasses
import json
import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from beam import Refusal
from studies.shell.scene import keys as scene_keys
from studies.shell.scene.key import GIVEN, LETTER, Key, SceneError, Value, shown
from studies.shell.scene.keys import FurtherStopKeys
from studies.shell.scene.mode_lists import LISTS, lists_in

T = TypeVar("T")

USUAL_MODES = 15
"""Modes kept where neither the scene nor a study says how many are needed."""


@dataclass(frozen=True, kw_only=True)
class Scene:
    """The sections, the further `stops`, and in `origins` the provenance of values that are no defaults (not
    part of equality)."""

    spring: scene_keys.SpringKeys = field(default_factory=scene_keys.SpringKeys)
    tip: scene_keys.TipKeys = field(default_factory=scene_keys.TipKeys)
    readout: scene_keys.ReadoutKeys = field(default_factory=scene_keys.ReadoutKeys)
    damping: scene_keys.DampingKeys = field(default_factory=scene_keys.DampingKeys)
    modes: scene_keys.ModesKeys = field(default_factory=scene_keys.ModesKeys)
    modal_data: scene_keys.ModalDataKeys = field(default_factory=scene_keys.ModalDataKeys)
    single_mode: scene_keys.SingleModeKeys = field(default_factory=scene_keys.SingleModeKeys)
    drive: scene_keys.DriveKeys = field(default_factory=scene_keys.DriveKeys)
    stop: scene_keys.StopKeys = field(default_factory=scene_keys.StopKeys)
    contact: scene_keys.ContactKeys = field(default_factory=scene_keys.ContactKeys)
    scan: scene_keys.ScanKeys = field(default_factory=scene_keys.ScanKeys)
    stops: tuple[FurtherStopKeys, ...] = ()
    origins: tuple[tuple[str, str], ...] = field(default=(), compare=False, repr=False)

    def __getitem__(self, key: str) -> Value:
        """The value of a dotted key, `scene["spring.width_m"]`."""
        section, name = split(key)
        value: Value = getattr(getattr(self, section), name)
        return value

    def number(self, key: str) -> float:
        """The value of a dotted key that is a number."""
        value = self[key]
        if not isinstance(value, float | int):
            raise SceneError(f"{key} is {shown(value)}; it must be a key that is a number")
        return value

    def replace(self, changes: Mapping[str, object], *, provenance: str = GIVEN) -> Scene:
        """The scene with other values for some dotted keys; `provenance` says where these come from.  The key
        `stops` takes a list of tables, which replaces all of them."""
        sections: dict[str, Any] = {}
        for key, value in changes.items():
            if key == "stops":
                sections[key] = further_stops(value)
                continue
            section, name = split(key)
            before = sections.get(section, getattr(self, section))
            sections[section] = dataclasses.replace(before, **{name: KEYS[key].checked(key, value)})
        origins = {**dict(self.origins), **dict.fromkeys(changes, provenance)}
        return dataclasses.replace(self, **sections, origins=tuple(origins.items()))

    def make(self, constructor: Callable[..., T], keys: Mapping[str, str], **others: object) -> T:
        """What `constructor` makes of the values of `keys`, argument -> dotted key, and of `others`.

        A Refusal becomes a SceneError with the keys in place of the arguments' names; so named are also
        arguments that are in both. Any other error is a bug and passes.
        """
        own = {name: self[key] for name, key in keys.items() if name not in others}
        try:
            return constructor(**own, **others)
        except Refusal as error:
            first, *parts = (keys.get(part, part) for part in error.args)
            raise SceneError(keys.get(error.field, first), *parts) from error

    def values(self) -> dict[str, object]:
        """Nested plain values, section -> key -> value, as a file holds them."""
        tables = dataclasses.asdict(self).items()
        return {name: table for name, table in tables if name != "origins" and table}  # no empty stops

    def provenance(self) -> dict[str, str]:
        """Dotted key -> letter, calibrated, assumed (a default), or as given to `replace`."""
        origins = dict(self.origins)
        found = {key: origins.get(key, GIVEN) for key in KEYS}
        found |= {key: LETTER for key, known in KEYS.items() if self[key] == known.printed}
        return found | {key: known.provenance for key, known in KEYS.items() if self[key] == known.default}

    def dump(self) -> str:
        """Every key as TOML, with meaning, unit and what is valid, default and provenance as comments."""
        provenance, parts = self.provenance(), list[str]()
        toml = partial(json.dumps, ensure_ascii=False)  # of texts, numbers and lists of numbers
        tables = [(f"[{section}]", f"{section}.", getattr(self, section)) for section in SECTIONS]
        for heading, section, table in [*tables, *(("[[stops]]", "stops.", stop) for stop in self.stops)]:
            lines = [f"# {' '.join((table.__doc__ or '').split())}", heading]
            for entry in dataclasses.fields(table):
                known, value = entry.metadata["key"], getattr(table, entry.name)
                origin = provenance.get(section + entry.name, GIVEN)
                here = "" if value == known.default else f"; here {origin}"
                lines += [
                    f"# {known.meaning}",
                    f"#   {known.valid()}; default {toml(known.default)}, {known.provenance}{here}",
                    f"{entry.name} = {toml(value)}",
                ]
            parts.append("\n".join(lines))
        return "\n\n".join(parts) + "\n"

    @property
    def kept_modes(self) -> int:
        """Modes kept: `modes.count`, or where that is 0 all that were measured, or the usual 15."""
        if self.modes.count:
            return self.modes.count
        if self.spring.kind == "modal_data":
            return len(self.modal_data.frequencies_hz)
        if self.damping.kind == "measured":
            return max(1, min(USUAL_MODES, len(self.damping.measured_rates_per_s)))
        return USUAL_MODES


SECTIONS = tuple(one.name for one in dataclasses.fields(Scene) if one.name not in ("stops", "origins"))
KEYS: dict[str, Key] = {
    f"{section}.{entry.name}": entry.metadata["key"]
    for section in SECTIONS
    for entry in dataclasses.fields(getattr(Scene(), section))
}
"""Every section and every dotted key, in the order of the files."""


def split(key: str) -> tuple[str, str]:
    """(section, name) of a dotted key, or a SceneError that names the nearest valid one."""
    section, dot, name = key.partition(".")
    if key in KEYS:
        return section, name
    if section.partition("[")[0] == "stops":
        raise SceneError(f"{shown(key)} cannot reach into [[stops]], a list of tables: change the file")
    namesakes = [known for known in KEYS if known.partition(".")[2] == key.rpartition(".")[2]]
    in_section = [known for known in KEYS if known.startswith(f"{section}.")] if dot else []
    nearest = get_close_matches(key[:100], namesakes or in_section or list(KEYS), n=1, cutoff=0.0)[0]
    raise SceneError(f"there is no key {shown(key)} in a scene: the nearest valid key is {nearest}")


def further_stops(tables: object) -> tuple[FurtherStopKeys, ...]:
    """The stops in the tables of [[stops]]; SceneError with the number of the table for what is wrong."""
    if not isinstance(tables, list | tuple) or not all(isinstance(table, Mapping) for table in tables):
        raise SceneError(f"stops is {shown(tables)}; it must be tables, each below a line [[stops]]")
    known = {entry.name: entry.metadata["key"] for entry in dataclasses.fields(FurtherStopKeys)}
    found = list[FurtherStopKeys]()
    for number, table in enumerate(tables, start=1):
        for name in table.keys() - known.keys():
            nearest = get_close_matches(name[:100], known, n=1, cutoff=0.0)[0]
            raise SceneError(f"[[stops]] {number} has no key {shown(name)}: the nearest is {nearest}")
        if "gap_m" not in table:
            raise SceneError(f"[[stops]] {number} has no gap_m, the distance of the stop (unit m): give it")
        checked = {name: known[name].checked(f"[[stops]] {number}: {name}", table[name]) for name in table}
        found.append(FurtherStopKeys(**checked))
    return tuple(found)


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
    changes: dict[str, object] = {}
    for section, entries in values.items():
        if section == "stops":
            changes[section] = entries
        elif not isinstance(entries, dict):
            split(section)
        elif section not in SECTIONS:
            split(".".join([section, *entries][:2]))
        else:
            changes |= {f"{section}.{entry}": value for entry, value in entries.items()}
    file = changes.get("modal_data.file")
    if folder is not None and isinstance(file, str) and file:
        changes["modal_data.file"] = str(folder / file)
    changes |= map(parse_override, overrides)
    scene = Scene().replace(changes)
    return with_measured_modes(scene) if scene.modal_data.file else scene


def parse_override(text: str) -> tuple[str, object]:
    """(dotted key, value) of `section.key=value`; the value is TOML, or else the bare text itself."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if not equals or "." not in key:
        raise SceneError(f"--set needs section.key=value, for instance stop.gap_m=0.011, not {shown(text)}")
    try:
        parsed = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return key, value
    return key, parsed["value"] if set(parsed) == {"value"} else value


def with_measured_modes(scene: Scene) -> Scene:
    """The scene with the lists in place of the file of measured modes: it then depends on no other file."""
    if any(getattr(scene.modal_data, entry) for entry in LISTS):
        raise SceneError("modal_data gives its modes twice, as lists and as a file: drop one of them")
    lists = lists_in(scene.modal_data.file).items()
    return scene.replace({"modal_data.file": ""} | {f"modal_data.{name}": values for name, values in lists})


def doubts(scene: Scene) -> Iterator[str]:
    """What is legal and can hardly be meant, beyond what the constructors of `beam` and `contact` warn of."""
    spring, gap, period = scene.spring, scene.stop.gap_m, scene.single_mode.free_period_s
    omega, leg, shaped = 2.0 * math.pi / period, spring.leg_length_m, spring.kind != "modal_data"
    damping, stiffness, radius = scene.damping, scene.contact.stiffness_n_per_m, scene.tip.ball_radius_m
    if shaped and gap > 0.1 * leg:
        wide = f"stop.gap_m is {gap:g} m, more than a tenth of spring.leg_length_m {leg:g} m"
        yield f"{wide}: the theory is that of small motion"
    if shaped and radius > leg:
        yield f"tip.ball_radius_m is {radius:g} m, more than spring.leg_length_m {leg:g} m"
    farthest = max(scene.drive.frequencies_hz, key=lambda frequency: abs(math.log(frequency * period)))
    if scene.drive.kind == "harmonic" and not 0.1 <= farthest * period <= 5.0:
        yield (
            f"drive.frequencies_hz has {farthest:g} Hz, {farthest * period:.3g} times the first mode by "
            "single_mode.free_period_s; between 0.1 and 5 one mode can describe the spring"
        )
    if scene.scan.born_excess > 0.1:
        yield f"scan.born_excess is {scene.scan.born_excess:g}, far from grazing"
    soft = scene.tip.mass_kg * omega**2
    if scene.contact.law == "linear" and 0.0 < stiffness < 10.0 * soft:
        words = f"below 10 times that of the ball on mode 1 ({soft:.3g} N/m): a spring, no stop"
        yield f"contact.stiffness_n_per_m is {stiffness:g} N/m, {words}"
    halves = {"decay_rate_per_s": 0.5 / omega, "ratio": 1.0, "loss_factor": 0.5}
    halves |= {"rayleigh_alpha_per_s": 0.5 / omega, "rayleigh_beta_s": 0.5 * omega}
    kinds = {"strips": "decay_rate_per_s", "constant_ratio": "ratio", "constant_loss_factor": "loss_factor"}
    kinds |= {"rayleigh": "rayleigh_alpha_per_s rayleigh_beta_s"}
    for name in kinds.get(damping.kind, "").split() if shaped else ():
        ratio = halves[name] * getattr(damping, name)
        if ratio > 0.5:
            yield f"damping.{name} makes a damping ratio of {ratio:.3g}; above 0.5 no mode oscillates"
