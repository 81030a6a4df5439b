"""From a TOML file to spring, modes, model and oscillators: what a study starts from.

    scene = read_scene("letter", ["drive.frequencies_hz=[22.2]"])    # a scene of ours by name, or any file
    spring_of(scene) -> modes_of(scene) -> model_of(scene)           # beam: drawing, modes, what impacts see
    beam_at(scene, f)                                                # the spring on its stops, at f [Hz]
    single_mode_at(scene, f), nordmark_at(scene, f)                  # Eq. (1) and Eqs. (2), (3) of the letter

The files
    ``key``      one key: default, unit, limits, and the check of a value
    ``keys``     every key of a scene, by section
    ``values``   `Scene`: the values, from TOML and overrides; its dump with comments
    ``law``      the contact law of a scene
    ``spring``   spring, modes and modal model of a scene
Here stand reading, checks that need several sections, oscillators, and drive frequencies of other springs.

Whatever is wrong is a `SceneError` of one sentence that names the key. The constructors of `beam` and
`contact` refuse, and the keys of the scene replace the names of their arguments. What is legal and can hardly
be meant brings a `SuspiciousValue` warning. Reading a scene solves no eigenvalue problem.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path

import contact
from beam import Backbone, ModalModel, Refusal, suspect
from contact import ContactError, ContactLaw, HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop
from studies import ROOT, letter
from studies.shell.programs import COMMAND
from studies.shell.scene.key import OPEN as OPEN
from studies.shell.scene.key import SceneError, shown
from studies.shell.scene.law import approach_speed as approach_speed
from studies.shell.scene.law import contact_law_of
from studies.shell.scene.law import hertz_of as hertz_of
from studies.shell.scene.spring import READOUT as READOUT
from studies.shell.scene.spring import (
    backbone_of,
    damping_of,
    model_of,
    require_drive_below,
    shift_at_gap,
    single_mode_of,
    spring_of,
    with_first_mode,
)
from studies.shell.scene.spring import first_mode as first_mode
from studies.shell.scene.spring import free_period as free_period
from studies.shell.scene.spring import modes_of as modes_of
from studies.shell.scene.spring import sections_of as sections_of
from studies.shell.scene.values import Scene, doubts, scene_from_text

SCENES = ROOT / "studies" / "scenes"

LARGEST_BANDS = range(3, 13)
"""Periods whose bands are looked at: edges lie closer and closer beyond."""

SAME_PERIOD, SAME_SPRING, TYPICAL = 1e-3, 0.005, 3.0
"""Relative change of T within which a spring counts as the letter's: twice the error of its 40.80 ms; that of
the first mode beyond which the born period changes next to a band edge; factor on the letter's amplitude."""

SAME_DRIVE = 3e-3
"""Relative difference of two f T that are taken for one: a fifth of the narrowest distance in Fig. 2."""


def read_scene(name: str | Path = "letter", overrides: Iterable[str] = ()) -> Scene:
    """The scene in a file, or of a name in studies/scenes, with overrides `section.key=value`; the last
    wins."""
    known = {file.stem: file for file in sorted(SCENES.glob("*.toml"))}
    path = known.get(str(name), Path(name))
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not text in UTF-8"
        choices = f"give a TOML file or one of {', '.join(known)}"
        raise SceneError(f"the scene {shown(str(name))} cannot be read: {reason}; {choices}") from error
    scene = scene_from_text(text, name=str(path), overrides=overrides, folder=path.parent)
    check(scene)
    scene = with_first_mode(scene)
    stops = [Stop(gap=scene.stop.gap_m, law=contact_law_of(scene)), *further_stops_of(scene)]
    scene.make(ImpactOscillator, {}, model=single_mode_of(scene), stops=stops)
    for sentence in doubts(scene):
        suspect(sentence)
    return scene


SMALLEST_GAP = 1e-12
"""Gap in front of which a drive can graze [m]: a hundredth of an atom, and its square is finite."""


def check(scene: Scene) -> None:
    """SceneError unless everything but the modes can be built from the scene."""
    spring, damping = scene.spring, scene.damping
    if scene.drive.kind == "harmonic" and not scene.stop.gap_m >= SMALLEST_GAP:
        gap, least = scene.stop.gap_m, SMALLEST_GAP
        raise SceneError(f"stop.gap_m must be at least {least:g} (unit m) when there is a drive, not {gap:g}")
    scene.make(Stop, {"gap": "stop.gap_m"}, law=contact_law_of(scene))
    further_stops_of(scene)
    for frequency in scene.drive.frequencies_hz:
        scene.make(HarmonicDrive, {"frequency": "drive.frequencies_hz"}, frequency=frequency)
    if scene.single_mode.restitution != OPEN:
        restitution_of(scene)
    if spring.kind == "modal_data":
        require_drive_below(scene, model_of(scene))
        return
    spring_of(scene)
    damping_of(scene)
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


def harmonic(scene: Scene) -> Scene:
    """The scene itself, or SceneError if its base is at rest."""
    if scene.drive.kind != "harmonic":
        raise SceneError(f"drive.kind is {scene.drive.kind}; this study needs a harmonic drive")
    return scene


def one_stop(scene: Scene) -> Scene:
    """The scene itself, or SceneError if it has further stops."""
    if scene.stops:
        raise SceneError("the scene has [[stops]], and this needs [stop] alone: take them out of the file")
    return scene


def further_stops_of(scene: Scene) -> list[Stop]:
    """The stops of [[stops]], each with the law of [contact] or its own."""
    found = []
    for number, keys in enumerate(scene.stops, start=1):
        own = scene if keys.law == "contact" else dataclasses.replace(scene, stop=keys, contact=keys)
        try:
            if keys.at == READOUT and scene.readout.quantity == "rotation":
                raise SceneError("at is readout, whose quantity is a rotation; a stop needs a displacement")
            found.append(Stop(gap=keys.gap_m, law=contact_law_of(own), at=keys.at, side=keys.side))
        except Refusal as error:
            raise SceneError(f"[[stops]] {number}: {error}") from error
    return found


def _on_stop(
    scene: Scene, model: ModalModel, law: ContactLaw, frequency: float, further: Sequence[Stop] = ()
) -> ImpactOscillator:
    def driven(gap: float, frequency: float) -> ImpactOscillator:
        drive = HarmonicDrive(frequency=frequency)
        return ImpactOscillator(model=model, stops=(Stop(gap=gap, law=law), *further), drive=drive)

    keys = {"gap": "stop.gap_m", "frequency": "drive.frequencies_hz"}
    return scene.make(driven, keys, frequency=frequency)


def beam_at(scene: Scene, frequency: float, model: ModalModel | None = None) -> ImpactOscillator:
    """The spring of the scene on all its stops, [stop] first, at drive `frequency` [Hz]; `model` saves
    computing its modes again."""
    known, further = model_of(scene) if model is None else model, further_stops_of(scene)
    return _on_stop(scene, known, contact_law_of(scene), frequency, further)


def single_mode_at(scene: Scene, frequency: float) -> ImpactOscillator:
    """Eq. (1) of the letter at drive frequency `frequency` [Hz], with the only gap of the scene."""
    return _on_stop(one_stop(scene), single_mode_of(scene), restitution_of(scene), frequency)


def restitution_of(scene: Scene) -> NewtonRestitution:
    """The law of Eq. (1); SceneError where the restitution is open, because no collision gave it."""
    if scene.single_mode.restitution == OPEN:
        raise SceneError("single_mode.restitution is open (-1), and no first collision gave it: give 0 to 1")
    return scene.make(NewtonRestitution, {"local_restitution": "single_mode.restitution"})


def nordmark_at(scene: Scene, frequency: float) -> contact.NordmarkMap:
    """Eqs. (2), (3) of the letter, corrected, at drive frequency `frequency` [Hz]."""
    return contact.NordmarkMap.from_oscillator(single_mode_at(scene, frequency))


EQ_1 = {"free_period": "single_mode.free_period_s", "decay_rate": "single_mode.decay_rate_per_s"}
EQ_1 |= {"restitution": "single_mode.restitution"}
"""Arguments of Eq. (1), and their keys."""


def band_of(scene: Scene, m: int) -> contact.Band:
    """The band of p_m of the map with the scene's single mode, `m` drive periods."""
    return scene.make(partial(contact.frequency_band, m), EQ_1)


def nonlinear_mode_at(
    scene: Scene, frequency: float, backbone: Backbone | None = None
) -> contact.NonlinearMode:
    """Eq. (1) of the letter at `frequency` [Hz] with cubic stiffness and inertia, by default the spring's."""
    cubic = backbone_of(scene) if backbone is None else backbone
    cubes = {"stiffness": cubic.stiffness, "inertia": cubic.inertia}
    keys = {"gap": "stop.gap_m"} | EQ_1
    return scene.make(contact.NonlinearMode, keys, frequency=frequency, **cubes)


def period_shifts(scene: Scene) -> Mapping[float, tuple[float, float]]:
    """What the amplitude of the gap does to the period that small deviations feel, and what it may do.

    Drive frequency [Hz] -> relative change of that period (infinite where no motion grazes as the linear one
    does), and the distance of the nearest edge of a band of p_m on that side, both relative [1].
    """
    edges = [edge for m in LARGEST_BANDS for edge in (band_of(scene, m).lower, band_of(scene, m).upper)]
    backbone, found = backbone_of(scene), dict[float, tuple[float, float]]()
    for frequency in scene.drive.frequencies_hz:
        try:
            period = nonlinear_mode_at(scene, frequency, backbone).effective_period
        except (ContactError, Refusal):
            period = math.inf
        shift = period / scene.single_mode.free_period_s - 1.0
        ways = [math.copysign(1.0, shift) * (edge / frequency - 1.0) for edge in edges]
        found[frequency] = shift, min((way for way in ways if way > 0.0), default=math.inf)
    return found


def beyond_linear(scene: Scene) -> str | None:
    """One sentence if the spring is too nonlinear at the gap for the periods that are born, else None."""
    if scene.drive.kind != "harmonic" or scene.single_mode.restitution == OPEN:
        return None
    shifts = period_shifts(scene)
    moved = {f"{f:g}": shift for f, (shift, margin) in shifts.items() if abs(shift) > margin}
    if not moved:
        return None
    most = max(moved.values(), key=abs)
    feels = f"small deviations feel a period {most:+.2%} off" if math.isfinite(most) else "no motion grazes"
    return (
        f"at the gap, stop.gap_m = {scene.stop.gap_m:g} m, the free frequency is {shift_at_gap(scene):+.2%} "
        f"off that of small amplitudes and {feels}, which can change the periods born at "
        f"{', '.join(moved)} Hz; the model is linear, and `{COMMAND} shape` says what is left of them"
    )


def corresponding(scene: Scene, letter_hz: float) -> float:
    """The drive frequency of the scene's spring that has the f T of the letter's `letter_hz` [Hz].

    By the letter's claim of universality the born period depends on f T alone, T the damped free period.
    """
    ratio = letter.FREE_PERIOD_S / scene.single_mode.free_period_s
    return letter_hz if abs(ratio - 1.0) <= SAME_PERIOD else float(f"{letter_hz * ratio:.5g}")


def own_frequency(scene: Scene, letter_hz: float) -> float:
    """The drive frequency [Hz] of a study of one frequency, the letter's `letter_hz` on the letter's scene.

    Another scene has its drive frequency with the same f T, if it is one of its own, or else its middle one.
    """
    there, drives = corresponding(scene, letter_hz), sorted(harmonic(scene).drive.frequencies_hz)
    near = min(drives, key=lambda frequency: abs(frequency - there))
    return near if abs(near / there - 1.0) <= SAME_DRIVE else drives[(len(drives) - 1) // 2]


def of_the_letter(scene: Scene) -> bool:
    """Whether T and mu, T of the spring's first mode, and roughly the drive amplitude are the letter's."""
    printed, first = letter.BREAKDOWN, free_period(scene)
    rate = scene.single_mode.decay_rate_per_s - printed["decay_rate_per_s"]
    same = corresponding(scene, 1.0) == 1.0 and abs(first / letter.FREE_PERIOD_S - 1.0) <= SAME_SPRING
    if not same or scene.stops or abs(rate) > printed["decay_rate_error_per_s"]:
        return False
    driven = _on_stop(scene, single_mode_of(scene), contact_law_of(scene), letter.TIME_TRACE_HZ)
    return 1.0 / TYPICAL <= driven.grazing_amplitude() / letter.DRIVE_AMPLITUDE_M <= TYPICAL


def periods_of(scene: Scene) -> Mapping[float, int]:
    """The letter's frequencies, scaled to the scene's spring [Hz], with the letter's periods."""
    return {corresponding(scene, f): m for f, m in letter.PERIODS.items()}
