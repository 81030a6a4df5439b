"""A scene: every number that a study starts from, checked once, immutable, hashable and picklable.

    scene = Scene()                                            # the letter's
    thinner = scene.replace({"spring.thickness_m": 0.00060})   # in the vocabulary of the files and of --set
    scene.spring.thickness_m                                   # plain floats, ints, texts, tuples of floats

Each section checks its own values (`quantities`); what ties several sections together is checked here.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from types import MappingProxyType
from typing import Any, cast

from studies.instruments.quantities import GIVEN, Key, SceneError, Section, keys_of, shown
from studies.instruments.scene_fields import (
    ContactKeys,
    DampingKeys,
    DriveKeys,
    ModalDataKeys,
    ModesKeys,
    ReadoutKeys,
    ScanKeys,
    SingleModeKeys,
    SpringKeys,
    StopKeys,
    TipKeys,
)

MODE_LISTS = ("frequencies_hz", "decay_rates_per_s", "tip_values", "participation")
"""The lists of [modal_data], one entry per mode."""


USUAL_MODES = 15
"""Modes kept where neither the scene nor a study says how many are needed."""


@dataclass(frozen=True, kw_only=True)
class Scene:
    """The sections, and in `origins` the provenance of values that are no defaults (not part of equality)."""

    spring: SpringKeys = field(default_factory=SpringKeys)
    tip: TipKeys = field(default_factory=TipKeys)
    readout: ReadoutKeys = field(default_factory=ReadoutKeys)
    damping: DampingKeys = field(default_factory=DampingKeys)
    modes: ModesKeys = field(default_factory=ModesKeys)
    modal_data: ModalDataKeys = field(default_factory=ModalDataKeys)
    single_mode: SingleModeKeys = field(default_factory=SingleModeKeys)
    drive: DriveKeys = field(default_factory=DriveKeys)
    stop: StopKeys = field(default_factory=StopKeys)
    contact: ContactKeys = field(default_factory=ContactKeys)
    scan: ScanKeys = field(default_factory=ScanKeys)
    origins: tuple[tuple[str, str], ...] = field(default=(), compare=False, repr=False)

    def __post_init__(self) -> None:
        for name, kind in SECTIONS.items():
            if type(getattr(self, name)) is not kind:
                raise TypeError(f"the section {name} of a Scene must be a {kind.__name__}")
        _check_stop(self)
        _check_strip(self)
        _check_damping(self)
        _check_modal_data(self)

    def __getitem__(self, key: str) -> Any:
        """The value of a dotted key, `scene["spring.width_m"]`."""
        section, name = split(key)
        return getattr(getattr(self, section), name)

    def replace(self, changes: Mapping[str, object], *, provenance: str = GIVEN) -> Scene:
        """The scene with other values for some dotted keys; `provenance` says where these come from."""
        by_section: dict[str, dict[str, Any]] = {}
        for key, value in changes.items():
            section, name = split(key)
            by_section.setdefault(section, {})[name] = value
        sections: dict[str, Any] = {
            section: dataclasses.replace(getattr(self, section), **values)
            for section, values in by_section.items()
        }
        origins = tuple({**dict(self.origins), **dict.fromkeys(changes, provenance)}.items())
        return dataclasses.replace(self, **sections, origins=origins)

    def as_dict(self) -> dict[str, dict[str, Any]]:
        """Nested plain values: what `scene_of` reads, a manifest stores and a cache key is made of."""
        return {
            section: {
                name: list(value) if isinstance(value, tuple) else value
                for name, value in dataclasses.asdict(getattr(self, section)).items()
            }
            for section in SECTIONS
        }

    def fingerprint(self) -> str:
        """A hash of all values, the same in every process and on every machine."""
        text = json.dumps(self.as_dict(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    def provenance(self) -> dict[str, str]:
        """Dotted key -> letter, calibrated, assumed (a default), or what `replace` was told (else given)."""
        origins, defaults = dict(self.origins), _defaults()
        return {
            key: entry.provenance if self[key] == defaults[key] else origins.get(key, GIVEN)
            for key, _, entry in keys()
        }

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

    def refuse_drive_above(self, highest_hz: float) -> None:
        """SceneError if a drive frequency lies above the highest mode retained, `highest_hz`."""
        fastest = max(self.drive.frequencies_hz)
        if self.drive.kind == "harmonic" and fastest > highest_hz:
            raise SceneError(
                f"drive.frequencies_hz has {fastest:g} Hz, above the highest of the modes kept "
                f"({highest_hz:.6g} Hz): drive more slowly or raise modes.count"
            )


SECTIONS: Mapping[str, type[Section]] = MappingProxyType(
    {
        entry.name: cast("type[Section]", entry.default_factory)
        for entry in dataclasses.fields(Scene)
        if entry.name != "origins"
    }
)
"""Section name -> its class, in the order of the files."""


def keys() -> Iterator[tuple[str, type, Key]]:
    """Every key: dotted name, type (float, int, str or tuple) and `Key`."""
    for section, kind in SECTIONS.items():
        for name, (plain, key) in keys_of(kind).items():
            yield f"{section}.{name}", plain, key


@cache
def _defaults() -> Mapping[str, Any]:
    scene = Scene()
    return MappingProxyType({key: scene[key] for key, _, _ in keys()})


def _nearest(word: str, words: Iterable[str]) -> str:
    return get_close_matches(word[:100], list(words), n=1, cutoff=0.0)[0]


def split(key: str) -> tuple[str, str]:
    """(section, name) of a dotted key, or a SceneError that names the nearest valid one."""
    section, dot, name = key.partition(".")
    if dot and section in SECTIONS and name in keys_of(SECTIONS[section]):
        return section, name
    valid = [known for known, _, _ in keys()]
    last = key.rpartition(".")[2]
    namesakes = [known for known in valid if known.partition(".")[2] == last]
    in_section = [known for known in valid if known.startswith(f"{section}.")] if dot else []
    nearest = _nearest(key, namesakes or in_section or valid)
    raise SceneError(f"there is no key {shown(key)} in a scene: the nearest valid key is {nearest}")


def scene_of(values: Mapping[str, Any], *, provenance: str = GIVEN) -> Scene:
    """The scene with these nested values (section -> key -> value) and defaults for the rest."""
    changes: dict[str, object] = {}
    for section, entries in values.items():
        if not isinstance(entries, Mapping):
            if section in SECTIONS:
                raise SceneError(f"{section} must be a section of keys, not {shown(entries)}")
            split(section)
        elif section not in SECTIONS:
            if len(entries) == 1:
                split(f"{section}.{next(iter(entries))}")
            nearest = _nearest(section, SECTIONS)
            unknown = shown(section)[1:-1]
            raise SceneError(f"there is no section [{unknown}] in a scene: the nearest is [{nearest}]")
        else:
            changes.update({f"{section}.{name}": value for name, value in entries.items()})
    return Scene().replace(changes, provenance=provenance)


def _check_stop(scene: Scene) -> None:
    if scene.drive.kind == "harmonic" and scene.stop.gap_m == 0.0:
        raise SceneError("stop.gap_m must be greater than 0 (unit m) when there is a drive, not 0.0")


def _check_strip(scene: Scene) -> None:
    spring = scene.spring
    if spring.kind == "folded_u" and spring.bend_radius_m <= spring.thickness_m / 2:
        raise SceneError(
            "spring.bend_radius_m must be greater than half of spring.thickness_m, "
            f"{spring.thickness_m / 2:g} (unit m), not {spring.bend_radius_m}"
        )


def _check_damping(scene: Scene) -> None:
    spring, damping = scene.spring, scene.damping
    if spring.kind == "modal_data":
        return
    if damping.kind == "strips" and 0.0 in (spring.tape_thickness_m, spring.tape_loss_factor):
        raise SceneError(
            "damping.kind strips needs a tape that dissipates, spring.tape_thickness_m and "
            "spring.tape_loss_factor greater than 0: give both or choose another damping.kind"
        )
    if damping.kind == "measured" and len(damping.measured_rates_per_s) < scene.kept_modes:
        raise SceneError(
            f"damping.kind measured needs a rate for each mode, {scene.kept_modes} (modes.count), but "
            f"damping.measured_rates_per_s (unit 1/s) has {len(damping.measured_rates_per_s)}"
        )


def _check_modal_data(scene: Scene) -> None:
    data = scene.modal_data
    if scene.spring.kind != "modal_data":
        return
    lengths = {name: len(getattr(data, name)) for name in MODE_LISTS}
    if len(set(lengths.values())) > 1 or 0 in lengths.values():
        raise SceneError(
            "spring.kind modal_data needs lists of equal length, one entry per mode, in modal_data, not "
            + ", ".join(f"{name} with {length}" for name, length in lengths.items())
        )
    scene.refuse_drive_above(max(sorted(data.frequencies_hz)[: scene.kept_modes]))

