"""Eq. (1) of a scene: what it takes from the beam, and where it describes another spring or no linear one.

Period and decay rate that a scene leaves open come from mode 1 (``studies.shell.scene``).  A restitution
that it leaves open is that of a first collision of the beam.
"""

import math
from collections.abc import Iterator

from contact import first_collision
from studies.physics.descriptions import or_none
from studies.physics.least_model import TRACE_EXCESS, middle_of
from studies.shell.scene import OPEN, SAME_SPRING, Scene, beam_at, beyond_linear, first_mode

SAME_DECAY = 0.05  # relative difference of two decay rates beyond which the second digit of a fold changes


def with_restitution(scene: Scene) -> tuple[Scene, str]:
    """The scene with a restitution of Eq. (1) where [single_mode] leaves it open, and a sentence on it.

    It is that of the first collision of the scene's model at excess 0.013 and the middle drive frequency.  It
    stays open where mode 1 does not come back from that collision, and of a scene with several stops.
    """
    if scene.single_mode.restitution != OPEN or scene.drive.kind != "harmonic" or scene.stops:
        return scene, ""
    oscillator = beam_at(scene, middle_of(scene))
    if oscillator.n_modes == 1 and scene.contact.law == "newton":
        value, words = scene.contact.local_restitution, "that of the stop"
    else:
        collision = or_none(first_collision, oscillator.with_excess(TRACE_EXCESS))
        value = math.nan if collision is None else collision.restitution
        words = f"of a first collision at {middle_of(scene):g} Hz, excess {TRACE_EXCESS:g}"
    if not 0.0 <= value <= 1.0:
        return scene, f"single_mode.restitution stays open: there is none between 0 and 1 {words}"
    value = float(f"{value:.9g}")
    changed = scene.replace({"single_mode.restitution": value}, provenance="first collision")
    return changed, f"single_mode.restitution is {value:.4g}, {words}"


def doubts(scene: Scene) -> Iterator[str]:
    """Sentences on an Eq. (1) that describes another spring than mode 1 does, and on a nonlinear spring."""
    limits = ("free_period_s", "s", SAME_SPRING), ("decay_rate_per_s", "1/s", SAME_DECAY)
    for (key, unit, limit), found in zip(limits, first_mode(scene), strict=True):
        given = getattr(scene.single_mode, key)
        if not abs(given - found) <= limit * min(given, found):
            yield (
                f"single_mode.{key} is {given:g} {unit}, but the first mode of the spring has {found:.5g} "
                f"{unit}: map and Eq. (1) describe another spring than the beam; -1 takes the value of mode 1"
            )
    if beyond := beyond_linear(scene):
        yield beyond
