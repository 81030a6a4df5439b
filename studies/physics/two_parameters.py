"""The letter's two parameters: one mode that rebounds as the beam does, restitution and delay by speed.

    restitution tau(v), delay d(v)     of the collision that ends the beam's motion without impacts, v [m/s]
                                       the approach speed of mode 1 (`contact.first_collision`)

at excesses from 1e-6 to 0.3, between which tau and d/v are interpolated in ln v. They make the rebound law of
Eq. (1) (`contact.DelayedRestitution`); what they leave out is the ringing that the next collision meets.

Below the slowest collision tau and d/v keep their values, with d < 2 v/a, a the deceleration of the tip.
Above the fastest tau and d keep theirs. A collision after which mode 1 does not come back to the gap has
neither, and is left out of the tables. See ``docs/theory/collision.md``.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy.interpolate import PchipInterpolator

from beam import ModalModel, Refusal
from contact import ContactError, DelayedRestitution, ImpactOscillator, State, first_collision
from contact.orbits import Kick, KickFamily, Shooting, fold_excess, onset_m
from studies.shell.scene import Scene, SceneError, beam_at, nordmark_at, single_mode_at

EXCESSES = np.geomspace(1e-6, 0.3, 45)  # of the first collisions

SHORTEST = 1e-12  # delay over the drive period below which it is rounding

FEWEST = 8  # collisions with a restitution that make a law


def law_of(oscillator: ImpactOscillator) -> DelayedRestitution:
    """The rebound law of a beam, from its first collisions; SceneError where too few have a restitution."""
    found = [first_collision(oscillator.with_excess(float(excess))) for excess in EXCESSES]
    kept = [one for one in found if np.isfinite([one.restitution, one.delay]).all()]
    if len(kept) < FEWEST:
        raise SceneError(
            f"contact.law leaves mode 1 a restitution in {len(kept)} of {len(found)} first collisions; two "
            f"parameters need {FEWEST} of them"
        )
    speed, restitution, delay = np.array([(one.approach, one.restitution, one.delay) for one in kept]).T
    # rounding, where mode 1 is all there is, in which no rebound can wait
    columns = restitution, np.where(delay > SHORTEST * oscillator.period, delay, 0.0) / speed
    tables = [PchipInterpolator(np.log(speed), values) for values in columns]

    def within(v: float) -> float:
        return float(np.log(np.clip(v, speed[0], speed[-1])))

    return DelayedRestitution(
        restitution=lambda v: float(tables[0](within(v))),
        delay=lambda v: v * float(tables[1](within(v))),
        speeds=(1e-3 * float(speed[0]), float(speed[-1])),
    )


def two_parameters_at(scene: Scene, frequency: float, model: ModalModel | None = None) -> ImpactOscillator:
    """Eq. (1) at drive `frequency` [Hz] with the rebound law of the scene's beam there."""
    oscillator = single_mode_at(scene, frequency)
    return replace(oscillator, stop=replace(oscillator.stop, law=law_of(beam_at(scene, frequency, model))))


def one_mode_fold(kicks: KickFamily, jump: Callable[[float], tuple[float, float]]) -> float | None:
    """The fold with a kick of mode 1 alone, `jump` of its displacement and velocity by approach velocity."""

    def kick(speed: float) -> Kick:
        of_all = np.zeros((kicks.oscillator.n_modes, 2))
        of_all[0] = jump(speed)
        return Kick(speed=speed, jump=of_all)

    found = replace(kicks, collision=kick).fold()
    return None if found is None else found.excess


def fold_of_kicks(kicks: KickFamily) -> float | None:
    """The fold of the two parameters without simulation: what each collision of the beam does to mode 1."""

    def jump(speed: float) -> tuple[float, float]:
        shift, velocity = kicks.kick(speed).jump[0]
        return float(shift), float(velocity)

    return one_mode_fold(kicks, jump)


@dataclass(frozen=True, kw_only=True)
class Extracted:
    """The two parameters at the approach speed of a settled orbit p_m with one impact."""

    frequency_hz: float
    m: int
    approach_m_per_s: Annotated[float, "approach speed [m/s]"]
    restitution: float
    delay_s: Annotated[float, "time delay [s]"]
    ringing_left: Annotated[float, "ringing left when the tip comes back; of a higher mode, exp(-c m/(2 f))"]
    fold: Annotated[float | None, "end of the orbit, F/F_g − 1; from the kicks of the beam's collisions"]
    map: Annotated[int, "born period of the map with that restitution; 0 where it did not settle"]
    fold_of_map: Annotated[float | None, "end of the orbit of that map, F/F_g − 1"]


def extracted(scene: Scene, frequency: float, model: ModalModel, *, end: State, m: int) -> Extracted | None:
    """What describes the settled orbit p_m that ends at `end`; None where it is not one with one impact."""
    beam, oscillator = beam_at(scene, frequency, model), two_parameters_at(scene, frequency, model)
    law, excess = oscillator.stop.law, scene.scan.born_excess
    family = Shooting(oscillator=oscillator.with_excess(excess), m=m)
    try:
        speed = abs(family.from_state(end).speed)
    except (ContactError, Refusal):
        return None
    assert isinstance(law, DelayedRestitution) and callable(law.restitution) and callable(law.delay)
    restitution = law.restitution(speed)
    strobed = replace(nordmark_at(scene, frequency), restitution=restitution)
    born = onset_m(strobed, excess, most_cycles=max(scene.scan.settle_cycles, 1))
    return Extracted(
        frequency_hz=frequency,
        m=m,
        approach_m_per_s=speed,
        restitution=restitution,
        delay_s=law.delay(speed),
        map=born,
        fold_of_map=fold_excess(strobed, born),
        ringing_left=float(np.exp(-0.5 * model.decay_rate[1:] * m / frequency).max(initial=0.0)),
        fold=fold_of_kicks(KickFamily(oscillator=beam, m=m)),
    )
