"""The letter's two parameters: one mode whose rebound, restitution and delay, is that of the beam."""

from __future__ import annotations

from dataclasses import replace

from beam import ModalModel
from contact import DelayedRestitution, ImpactOscillator, first_collision
from studies import letter
from studies.scene import Scene, beam_at, single_mode_at

__all__ = ["two_parameters_at"]


def two_parameters_at(scene: Scene, frequency: float, model: ModalModel | None = None) -> ImpactOscillator:
    """Eq. (1) at drive `frequency` [Hz] with restitution, and delay over approach speed, of one first
    collision of the beam, at the excess of the letter's Fig. 4."""
    hit = first_collision(beam_at(scene, frequency, model).with_excess(letter.TIME_TRACE_EXCESS))
    law = DelayedRestitution(
        restitution=hit.restitution, delay=lambda v: hit.delay * min(1.0, v / hit.approach),
        speeds=(1e-6, 10.0),
    )  # fmt: skip
    one = single_mode_at(scene, frequency)
    return replace(one, stop=replace(one.stop, law=law))
