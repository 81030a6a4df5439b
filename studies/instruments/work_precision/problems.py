"""The problems on which methods are compared, each with a motion for the errors and one for the cost.

    single mode     Eq. (1) of the letter with the hard wall, tau, mu and T of the scene
    linear          the scene's beam with a linear contact that lasts as long as Hertz's
    hertz           the scene's beam with the scene's Hertz contact
    swung beam      code_aster's SDNL32: a beam pinned at one end swings on a spring, no drive

Driven problems run at 21.50 Hz and F/F_g - 1 = 0.013 (the letter's Fig. 4, where its trace is p4; Eq. (1)
settles on a p8 close to it).  The error run starts from the steady motion at its lowest point, meets the stop
once, and is compared one drive period after its start.  The cost run follows the settled orbit.

Modal errors are given in units of what mode 1 does at grazing: displacement gap/phi_1, velocity w gap/phi_1;
for the swung beam 5 mm, the largest deflection in its source, and the tip's first speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.collision import before_collision, first_collision
from contact.laws import HERTZ, LINEAR, LinearContact
from contact.orbits.continuation import fold_of
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.oscillators import beam_of, hertz_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.work_precision.swung_beam import LENGTH, TURNING, swung_beam

__all__ = ["FoldPoint", "Problem", "driven_problem", "problems_of"]

FREQUENCY, PERIOD = 21.50, 4
"""Drive frequency [Hz] and period of the maximal orbit of the letter's Fig. 4."""

EXCESS = 0.013
"""F/F_g - 1 in the letter's Fig. 4."""

MODES = 8
"""Modes of the beam: the highest, at 3.3 kHz, swings a fifth of a turn during a contact."""

SETTLING = 600
"""Drive periods after which the orbit repeats to rounding: a free motion falls to 0.92 in each."""

LONGEST = 16
"""Longest period of a settled orbit that is looked for; a motion without one is followed that long."""

@dataclass(frozen=True, kw_only=True, eq=False)
class FoldPoint:
    """The orbit at the fold of p_m, as a point of the m-period map: amplitude [m] and state at a strobe."""

    oscillator: ImpactOscillator
    state: State
    periods: int
    excess: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """A motion to be computed by every method.

    Parameters
    ----------
    name, title : str
        Under which its rows are listed; what a figure says.
    oscillator : ImpactOscillator
    start : State
        Of the error run.
    probe : float
        Time at which its state is compared [s].
    duration : float
        Length of the error run; its collision is final then [s].
    period : float
        Unit of time: the drive period, or the swung beam's whole run [s].
    size, speed : float
        Scales of mode 1's displacement and velocity [m kg^0.5], [m kg^0.5/s].
    mode : int
        Number of the mode compared.
    timed_end : bool
        Whether the instant compared is the first release (the first touch is where the run starts).
    cost_start : State
    cost_periods : int
        Periods of the cost run.
    contact_time : float
        Of the first touch, 0 for an impact law [s].
    collision : (float, float) or None
        t_in and t_out of the first collision in doubles [s]; None if it has no restitution.
    touches : int
        Touches in that collision.
    fold : FoldPoint or None
    unit : str
        What `period` is called.
    """

    name: str
    title: str
    oscillator: ImpactOscillator
    start: State
    probe: float
    duration: float
    period: float
    size: float
    speed: float
    cost_start: State
    cost_periods: int
    contact_time: float
    mode: int = 0
    timed_end: bool = False
    collision: tuple[float, float] | None = None
    touches: int = 1
    fold: FoldPoint | None = None
    unit: str = "drive period"

    @property
    def law(self) -> int:
        """Code of the contact law."""
        return self.oscillator.stop.law.code

    @property
    def scales(self) -> tuple[np.ndarray, np.ndarray]:
        """`size` and `speed` for every mode."""
        n = self.oscillator.n_modes
        return np.full(n, self.size), np.full(n, self.speed)


def fold_point(oscillator: ImpactOscillator, periods: int) -> FoldPoint | None:
    """The fold of p_m by closed form (Newton's law) or shooting, taken to the strobe after its impact."""
    drive, model = oscillator.drive, oscillator.model
    assert drive is not None
    if oscillator.stop.law.code in (LINEAR, HERTZ):
        orbit = fold_of(Shooting(oscillator=oscillator, period=periods))
        if orbit is None:
            return None
        driven = oscillator.with_amplitude(orbit.amplitude)
        state = replace(orbit, oscillator=driven).strobe_state()
        excess = orbit.excess
    else:
        family = MaximalFamily(
            omega=model.omega, decay_rate=model.decay_rate, phi=model.phi, participation=model.participation,
            drive_frequency=drive.frequency, gap=oscillator.stop.gap, period=periods,
            restitution=oscillator.stop.law.numbers[0],
        )  # fmt: skip
        at_fold = family.fold()
        if at_fold is None:
            return None
        driven, excess = oscillator.with_amplitude(at_fold.amplitude), at_fold.excess
        strobe = oscillator.period * math.ceil(at_fold.flight.start / oscillator.period)
        q, v = at_fold.state(strobe)
        state = State(displacement=q, velocity=v)
    state = State(displacement=state.displacement, velocity=state.velocity)  # strobes are alike
    return FoldPoint(oscillator=driven, state=state, periods=periods, excess=excess)


def driven_problem(
    name: str, title: str, oscillator: ImpactOscillator, *, periods: int = PERIOD, fold: bool = True
) -> Problem:
    """The problem of `oscillator`, driven above grazing; `fold` asks for the fold of p_m, m = `periods`."""
    drive, gap = oscillator.drive, oscillator.stop.gap
    assert drive is not None
    start, period = before_collision(oscillator), oscillator.period
    met = first_collision(oscillator, start)
    run = simulate(oscillator, start, periods=SETTLING)
    size = gap / abs(float(oscillator.model.phi[0]))
    tips = run.strobe_displacement[:, 0] / size
    repeats = [m for m in range(1, LONGEST + 1) if np.ptp(tips[-1 : -3 * m - 1 : -m]) < 1e-9]
    return Problem(
        name=name, title=title, oscillator=oscillator, start=start, probe=start.time + period,
        duration=1.3 * period, period=period, size=size, speed=size * drive.angular_frequency,
        cost_start=State(displacement=run.strobe_displacement[-1], velocity=run.strobe_velocity[-1]),
        cost_periods=repeats[0] if repeats else LONGEST, contact_time=met.contact_time,
        collision=(met.time, met.time + met.delay) if math.isfinite(met.delay) else None,
        touches=met.impacts,
        fold=fold_point(oscillator, periods) if fold else None,
    )  # fmt: skip


def linear_beam(scene: Scene, frequency: float, excess: float) -> ImpactOscillator:
    """The scene's beam with a linear contact that lasts as long as Hertz's in the first collision."""
    beam = replace(beam_of(scene, frequency), stop=Stop(gap=scene.stop.gap_m, law=hertz_of(scene)))
    wanted = first_collision(beam.with_excess(excess)).contact_time

    def with_stiffness(stiffness: float) -> ImpactOscillator:
        stop = Stop(gap=scene.stop.gap_m, law=LinearContact(stiffness=stiffness))
        return replace(beam, stop=stop).with_excess(excess)

    stiffness = (math.pi / wanted) ** 2 / float(beam.model.phi @ beam.model.phi)
    for _ in range(40):  # contact times go as k^(-1/2); each turn leaves a tenth of the difference or less
        lasts = first_collision(with_stiffness(stiffness)).contact_time
        if abs(lasts / wanted - 1.0) < 1e-12:
            break
        stiffness *= (lasts / wanted) ** 2
    return with_stiffness(stiffness)


def swung_problem() -> Problem:
    """SDNL32 with the stiffer spring, which the tip leaves before 12 ms."""
    oscillator, start = swung_beam(45000.0)
    touches = simulate(oscillator, start, duration=0.012).impacts
    phi = float(oscillator.model.phi[0])
    return Problem(
        name="swung beam", title="SDNL32, 10 modes, linear contact", oscillator=oscillator, start=start,
        probe=0.012, duration=0.012, period=0.012, size=0.005 / phi, speed=TURNING * LENGTH / phi,
        timed_end=True, unit="12 ms", cost_start=start, cost_periods=1,
        contact_time=float(touches.end[0] - touches.start[0]),
    )  # fmt: skip


def problems_of(scene: Scene, *, modes: int = MODES) -> list[Problem]:
    """The four problems of the study."""
    beam = scene.replace({"modes.count": modes})
    hertz = replace(beam_of(beam, FREQUENCY), stop=Stop(gap=scene.stop.gap_m, law=hertz_of(scene)))
    return [
        driven_problem(
            "single mode", "Eq. (1), hard wall", single_mode_oscillator(scene, FREQUENCY).with_excess(EXCESS)
        ),
        driven_problem(
            "linear", f"beam, {modes} modes, linear contact", linear_beam(beam, FREQUENCY, EXCESS)
        ),
        driven_problem("hertz", f"beam, {modes} modes, Hertz contact", hertz.with_excess(EXCESS)),
        swung_problem(),
    ]
