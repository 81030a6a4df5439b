"""Values of a scene that are valid and can hardly be meant.

    for sentence in suspicions(scene):
        warnings.warn(sentence, SuspiciousValue)

Most of them are slips of a unit (millimetres for metres, gigapascals for pascals, rad/s for Hz), the others
leave the theory: a bar in place of a strip, a stop beyond small motion, a damping under which no mode swings.
Each threshold is a constant with its reason.  A scene with suspicious values is computed as it stands; the
sentences go to standard error and into the summary.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator

from beam import SuspiciousValue
from studies.instruments.calibration import free_period
from studies.instruments.oscillators import contact_law_of
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import spring_of

__all__ = ["suspicions"]

SMALL_MOTION = 0.1
"""Tip motion over the length of a leg beyond which slopes of 0.15 rad and more are no longer small."""

SLENDEREST = 5000.0
"""Length of a leg over its thickness beyond which it is a ribbon that hangs under its own weight: a brass
strip of 0.7 mm and 3.5 m."""

GREATEST_RATIO = 0.5
"""Damping ratio beyond which modes hardly swing, and no measured spring is: damping alloys reach 0.1."""

GREATEST_LOSS = 3.0
"""Loss factor beyond the best damping polymers (1 to 2)."""

DRIVE_OVER_MODE = (0.1, 5.0)
"""Drive frequency over that of [single_mode] between which Eq. (1) can describe the spring: the letter drives
at 0.85 to 0.96 of it, and higher modes lead beyond 5."""

REFUSED = 100.0
"""The same from which on no mode that is kept follows, and the drive is refused where the modes are made."""

LEAST_STIFFNESS = 10.0
"""Stiffness of the stop over that of the tip's mass on mode 1, below which it is a second spring."""

SAME_SPRING = 0.005
"""Relative difference of two free periods beyond which the born period changes next to a band edge."""

NEAR_GRAZING = 0.1
"""Excess beyond which the born period is no longer one at grazing; the letter's are below 0.02."""


def suspicions(scene: Scene) -> tuple[str, ...]:
    """One sentence for each suspicious value, none for most scenes."""
    found = [*_of_the_keys(scene)]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", SuspiciousValue)
        for make in (spring_of, contact_law_of):
            try:
                make(scene)
            except ValueError:  # refused with a sentence of its own where it is used
                continue
    found += [str(warning.message) for warning in told if issubclass(warning.category, SuspiciousValue)]
    if not found:  # any of the above would move the first mode, too
        found += [*_of_first_mode(scene)]
    return tuple(dict.fromkeys(found))


def _of_the_keys(scene: Scene) -> Iterator[str]:
    yield from _of_lengths(scene)
    yield from _of_times(scene)
    yield from _of_damping(scene)
    yield from _of_contact(scene)


def _of_lengths(scene: Scene) -> Iterator[str]:
    spring, gap = scene.spring, scene.stop.gap_m
    if spring.kind == "modal_data":
        return
    leg = spring.leg_length_m
    if gap > leg:
        yield f"stop.gap_m is {gap:g} m, more than the length of the spring, spring.leg_length_m {leg:g} m"
    elif gap > SMALL_MOTION * leg:
        yield (
            f"stop.gap_m is {gap:g} m, more than {SMALL_MOTION:g} of spring.leg_length_m {leg:g} m: the "
            "theory is that of small motion"
        )
    if spring.width_m > leg:
        yield f"spring.width_m is {spring.width_m:g} m, more than spring.leg_length_m {leg:g} m: a plate"
    if leg > SLENDEREST * spring.thickness_m:
        yield (
            f"spring.leg_length_m is {leg:g} m, more than {SLENDEREST:g} times spring.thickness_m "
            f"{spring.thickness_m:g} m: it hangs under its own weight"
        )
    if spring.kind == "folded_u" and spring.bend_radius_m > leg:
        yield f"spring.bend_radius_m is {spring.bend_radius_m:g} m, more than spring.leg_length_m {leg:g} m"
    if scene.tip.ball_radius_m > leg:
        yield f"tip.ball_radius_m is {scene.tip.ball_radius_m:g} m, more than spring.leg_length_m {leg:g} m"


def _of_times(scene: Scene) -> Iterator[str]:
    if scene.drive.kind != "harmonic":
        return
    first, name = 1.0 / scene.single_mode.free_period_s, "single_mode.free_period_s"
    if scene.spring.kind == "modal_data":
        first, name = min(scene.modal_data.frequencies_hz), "modal_data.frequencies_hz"
    low, high = DRIVE_OVER_MODE
    farthest = max(scene.drive.frequencies_hz, key=lambda frequency: abs(math.log(frequency / first)))
    if not low * first <= farthest <= high * first and farthest < REFUSED * first:
        yield (
            f"drive.frequencies_hz has {farthest:g} Hz, {farthest / first:.3g} times the first mode "
            f"({first:.3g} Hz by {name}); between {low:g} and {high:g} one mode can describe the spring"
        )
    if scene.scan.born_excess > NEAR_GRAZING:
        yield f"scan.born_excess is {scene.scan.born_excess:g}, above {NEAR_GRAZING:g} and far from grazing"


def _of_first_mode(scene: Scene) -> Iterator[str]:
    try:
        period = free_period(scene)
    except ValueError:  # refused with a sentence of its own where the modes are made
        return
    told = scene.single_mode.free_period_s
    if not abs(told / period - 1.0) <= SAME_SPRING:
        yield (
            f"single_mode.free_period_s is {told:g} s, but the first mode of the spring has {period:.5g} s: "
            "map and Eq. (1) describe another spring than the beam does"
        )


def _of_damping(scene: Scene) -> Iterator[str]:
    omega = 2.0 * math.pi / scene.single_mode.free_period_s
    keys = scene.damping
    ratios = {"single_mode.decay_rate_per_s": 0.5 * scene.single_mode.decay_rate_per_s / omega}
    if scene.spring.kind == "modal_data":
        rates = zip(scene.modal_data.decay_rates_per_s, scene.modal_data.frequencies_hz, strict=True)
        ratios["modal_data.decay_rates_per_s"] = max(0.25 * c / (math.pi * f) for c, f in rates)
    elif keys.kind == "strips":
        ratios["damping.decay_rate_per_s"] = 0.5 * keys.decay_rate_per_s / omega
    elif keys.kind == "constant_ratio":
        ratios["damping.ratio"] = keys.ratio
    elif keys.kind == "constant_loss_factor":
        ratios["damping.loss_factor"] = 0.5 * keys.loss_factor
    elif keys.kind == "rayleigh":
        ratios["damping.rayleigh_alpha_per_s"] = 0.5 * keys.rayleigh_alpha_per_s / omega
        ratios["damping.rayleigh_beta_s"] = 0.5 * keys.rayleigh_beta_s * omega
    elif keys.kind == "measured":
        ratios["damping.measured_rates_per_s"] = 0.5 * keys.measured_rates_per_s[0] / omega
    for name, ratio in ratios.items():
        if ratio > GREATEST_RATIO:
            yield f"{name} makes a damping ratio of {ratio:.3g}; above {GREATEST_RATIO:g} no mode swings"
    for name in ("spring.loss_factor", "spring.tape_loss_factor"):
        if scene[name] > GREATEST_LOSS:
            yield f"{name} is {scene[name]:g}; materials stay below {GREATEST_LOSS:g}"


def _of_contact(scene: Scene) -> Iterator[str]:
    stiffness, mass = scene.contact.stiffness_n_per_m, scene.tip.mass_kg
    soft = mass * (2.0 * math.pi / scene.single_mode.free_period_s) ** 2
    if scene.contact.law == "linear" and 0.0 < stiffness < LEAST_STIFFNESS * soft:
        yield (
            f"contact.stiffness_n_per_m is {stiffness:g} N/m, less than {LEAST_STIFFNESS:g} times that of "
            f"the ball on mode 1 ({soft:.3g} N/m): a second spring, no stop"
        )
