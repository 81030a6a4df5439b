"""The problems on which methods are compared, each with a motion for the errors and one for the cost.

    Eq. (1)         Eq. (1) of the letter with the hard wall, tau, mu and T of the scene
    beam, linear    the scene's beam with a linear contact that lasts as long as Hertz's
    beam, Hertz     the scene's beam with the scene's Hertz contact
    two masses      example 03 of NLvib (M. Krack and J. Gross, Harmonic Balance for Nonlinear Vibration
                    Problems, Springer 2019; maltekrack/NLvib at 69598c5): a periodic motion, by harmonic
                    balance, shooting and settling

They run at 21.50 Hz and F/F_g - 1 = 0.013 (the letter's Fig. 4, where its trace is p4; Eq. (1)
settles on a p8 close to it). The error run starts from the steady motion at its lowest point, meets the stop
once, and is compared one drive period after its start. The cost run follows the settled orbit.

Errors of mode 1 are given in units of what it does at grazing: displacement gap/phi_1, velocity w gap/phi_1.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from beam import ModalModel
from contact import (
    HarmonicDrive,
    ImpactOscillator,
    LinearContact,
    State,
    Stop,
    StroboscopicMap,
    before_collision,
    first_collision,
)
from contact.orbits import settle
from studies.letter import TIME_TRACE_EXCESS, TIME_TRACE_HZ
from studies.shell.scene import Scene, beam_at, hertz_of, single_mode_at

EQ_1, HERTZ = "Eq. (1)", "beam, Hertz contact"

MODES = 8  # modes of the beam: the highest, at 3.3 kHz, turns by a fifth during a contact

SETTLING = 4000  # drive periods within which the orbit has settled: a free motion falls to 0.92 in each

UNSETTLED = 16  # drive periods of the cost run where the motion has no period


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """A motion to be computed by every method."""

    name: str
    title: str  # under which its rows are listed; what a figure says
    oscillator: ImpactOscillator
    start: State  # of the error run
    probe: float
    duration: float
    """Time at which mode 1 is compared, and length of the error run; with a drive it goes on beyond the
    probe, so that no step is cut short for it [s]."""
    period: float  # unit of time: the drive period, or the free beam's whole run [s]
    size: float
    speed: float  # scales of mode 1's displacement and velocity [m kg^0.5], [m kg^0.5/s]
    cost_start: State
    cost_periods: int  # on the settled orbit; units of time in which that repeats
    contact_time: float  # of the first touch, 0 for an impact law [s]
    unit: str = "drive period"  # what a cost is the time for


def driven_problem(name: str, title: str, oscillator: ImpactOscillator) -> Problem:
    """The problem of `oscillator`, driven above grazing."""
    size, strobed = oscillator.stop.gap / abs(oscillator.model.phi[0]), StroboscopicMap(oscillator=oscillator)
    settled, start = settle(strobed, strobed.steady(), most_cycles=SETTLING), before_collision(oscillator)
    return Problem(
        name=name,
        title=title,
        oscillator=oscillator,
        start=start,
        probe=start.time + oscillator.period,
        duration=1.3 * oscillator.period,
        period=oscillator.period,
        size=size,
        speed=2.0 * math.pi / oscillator.period * size,
        cost_start=replace(settled.end, time=0.0),
        cost_periods=settled.m or UNSETTLED,
        contact_time=first_collision(oscillator).contact_time,
    )


def linear_beam(scene: Scene) -> ImpactOscillator:
    """The scene's beam with a linear contact that lasts as long as Hertz's in the first collision."""
    hertz = hertz_beam(scene)
    wanted = first_collision(hertz).contact_time

    def with_stiffness(stiffness: float) -> ImpactOscillator:
        return replace(hertz, stop=Stop(gap=hertz.stop.gap, law=LinearContact(stiffness=stiffness)))

    def longer(stiffness: float) -> float:
        return first_collision(with_stiffness(stiffness)).contact_time - wanted

    guess = (math.pi / wanted) ** 2 / float(hertz.model.phi @ hertz.model.phi)
    return with_stiffness(float(brentq(longer, 0.25 * guess, 4.0 * guess, xtol=1e-13 * guess)))


def hertz_beam(scene: Scene) -> ImpactOscillator:
    """The scene's beam with the scene's Hertz contact, at the excess of Fig. 4."""
    stop = Stop(gap=scene.stop.gap_m, law=hertz_of(scene))
    return replace(beam_at(scene, TIME_TRACE_HZ), stop=stop).with_excess(TIME_TRACE_EXCESS)


def two_masses(w: float, force: float = 0.1) -> ImpactOscillator:
    """Two unit masses, driven at W = `w` [rad/s] by `force` [N] on mass 2; SI units.

    Springs 0, 1, 1 with dampers 0.03 times these, and a one-sided spring of 100 at gap 1 on mass 1. A
    constant force on coordinate j is participation_k = phi_k(j) with the base amplitude Z = f/W^2.
    """
    squares, shapes = np.linalg.eigh(np.array([[1.0, -1.0], [-1.0, 2.0]]))
    model = ModalModel(
        omega=np.sqrt(squares), decay_rate=0.03 * squares, phi=shapes[0], participation=shapes[1]
    )
    drive = HarmonicDrive(frequency=w / (2.0 * np.pi), amplitude=force / w**2)
    return ImpactOscillator(model=model, stop=Stop(gap=1.0, law=LinearContact(stiffness=100.0)), drive=drive)


def problems_of(scene: Scene, modes: int = MODES) -> list[Problem]:
    """The driven problems of the study, the beam with `modes` modes."""
    beam = scene.replace({"modes.count": modes})
    one = single_mode_at(scene, TIME_TRACE_HZ).with_excess(TIME_TRACE_EXCESS)
    return [
        driven_problem(EQ_1, "Eq. (1), hard wall", one),
        driven_problem("beam, linear contact", f"beam, {modes} modes, linear contact", linear_beam(beam)),
        driven_problem(HERTZ, f"beam, {modes} modes, Hertz contact", hertz_beam(beam)),
    ]
