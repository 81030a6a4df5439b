"""Oscillators that several tests of contact take: a spring of six modes, Eq. (1) of the letter."""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from beam import ModalModel, Point, single_mode
from contact import ContactLaw, HarmonicDrive, ImpactOscillator, LinearContact, NewtonRestitution, State, Stop

OMEGA = 2 * np.pi * 24.5 * np.array([1.0, 6.1, 15.4, 29.0, 47.0, 70.0])
PHI = 10.0 * np.array([1.0, 0.7, 0.5, 0.4, 0.3, 0.25])
LIGHT = 10.0 * np.array([1.0, 0.9, 0.8, 0.7, 0.6, 0.5])  # with a light tip
GAMMA = np.array([0.09, 0.05, -0.03, 0.02, -0.015, 0.01])
GAP = 0.005
FREQUENCY = 21.5
THROWN = State(displacement=np.zeros(3), velocity=np.array([0.15, 0.02, 0.01]))
"""Three modes on their way to the stop, which they touch after some 4 ms."""

# under-, over- and critically damped modes beside the first; a light and a heavy tip
ROWS = {
    "three modes": ([154.0, 960.0, 2690.0], [3.56, 19.2, 80.0], [7.1, -6.5, 5.2], [0.09, -0.05, 0.03]),
    "an overdamped mode": ([154.0, 500.0], [3.56, 1300.0], [7.1, 4.0], [0.09, 0.04]),
    "a critical mode": ([154.0, 600.0], [3.56, 1200.0], [7.1, 4.0], [0.09, 0.04]),
    "an undamped mode": ([154.0, 1000.0], [3.56, 0.0], [7.1, 3.0], [0.09, 0.0]),
}
ARRAYS = ("omega", "decay_rate", "phi", "participation")
MODES = {name: dict(zip(ARRAYS, rows, strict=True)) for name, rows in ROWS.items()}


def slow(*cases: object) -> list:
    """Cases that only the long form of a test has; a tuple holds one value for each argument."""
    rows = (case if isinstance(case, tuple) else (case,) for case in cases)
    return [pytest.param(*row, marks=pytest.mark.slow) for row in rows]


def newton(restitution: float) -> NewtonRestitution:
    return NewtonRestitution(local_restitution=restitution)


def modes_on_stop(
    omega: object,
    decay: object = 0.0,
    phi: object = 1.0,
    participation: object = 0.0,
    *,
    law: ContactLaw | None = None,
    gap: float = 0.01,
    drive: object = None,
    load: object = None,
) -> ImpactOscillator:
    """Modes before a stop, under Newton's law with restitution 1/2 by default; a number holds for every mode.

    drive = frequency [Hz], or (frequency, amplitude [m]).
    """
    omega, decay, phi, participation = np.broadcast_arrays(np.atleast_1d(omega), decay, phi, participation)
    model = ModalModel(omega=omega, decay_rate=decay, phi=phi, participation=participation)
    base = drive and HarmonicDrive(**dict(zip(("frequency", "amplitude"), np.ravel(drive), strict=False)))
    stop, force = Stop(gap=gap, law=law or newton(0.5)), None if load is None else load + 0.0 * omega
    return ImpactOscillator(model=model, stop=stop, drive=base, load=force)


def before_stops(
    omega: np.ndarray, decay: np.ndarray, gamma: np.ndarray, rows: np.ndarray, stops: list, **more: object
) -> ImpactOscillator:
    """Modes, and (gap, law) of a stop before the point of each of the `rows`."""
    points = {f"{number}": Point(row=row) for number, row in enumerate(rows)}
    numbers = dict(omega=omega, decay_rate=decay, phi=rows[0], participation=gamma)
    model = ModalModel(**numbers, points=points, dimensionless=True)
    placed = [Stop(gap=gap, law=law, at=name) for name, (gap, law) in zip(points, stops, strict=True)]
    return ImpactOscillator(model=model, stops=placed, **more)


def spring(
    n_modes: int,
    law: ContactLaw,
    *,
    damping: float = 0.02,
    drive: tuple[float, float] | None = None,
    phi: np.ndarray = PHI,
    load: np.ndarray | None = None,
    turned: bool = False,
) -> ImpactOscillator:
    """The first modes of a spring of 24.5 Hz with a stop at 5 mm; drive = (frequency [Hz], amplitude [m]).

    `turned` is the same spring half a drive period later.
    """
    omega, gamma = OMEGA[:n_modes], (-1 if turned else 1) * GAMMA[:n_modes]
    rows = omega, damping * omega, phi[:n_modes], gamma
    return modes_on_stop(*rows, law=law, gap=GAP, drive=drive, load=load)


def light_tip(
    n_modes: int,
    law: ContactLaw,
    *,
    excess: float | None = 0.05,
    damping: float = 0.02,
    frequency: float = 21.5,
    turned: bool = False,
) -> ImpactOscillator:
    """The same spring with a light tip, for collisions; undriven if `excess` is None."""
    drive = None if excess is None else (frequency, 0.0)
    light = spring(n_modes, law, damping=damping, phi=LIGHT, drive=drive, turned=turned)
    return light if excess is None else light.with_excess(excess)


def many_modes(name: str, *, restitution: float = 0.35, **changes: list[float]) -> ImpactOscillator:
    """One of `MODES` under Newton's law at 20.5 Hz."""
    numbers = (MODES[name] | changes).values()
    return modes_on_stop(*numbers, law=newton(restitution), gap=0.012, drive=20.5)


def equation_1(
    frequency: float, law: ContactLaw | None = None, *, gap: float = 1.0, excess: float | None = None
) -> ImpactOscillator:
    """Eq. (1) of the letter, with its restitution of 0.1 by default; in gaps unless `gap` [m] is given."""
    model, drive = single_mode(free_period=40.80e-3, decay_rate=3.56), HarmonicDrive(frequency=frequency)
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=gap, law=law or newton(0.1)), drive=drive)
    return oscillator if excess is None else oscillator.with_excess(excess)


def two_masses(w: float, force: float) -> ImpactOscillator:
    """Example 03 of NLvib (M. Krack and J. Gross, Harmonic Balance for Nonlinear Vibration Problems, 2019).

    Masses 1 and 1, springs 0, 1, 1 with dampers 0.03 times these, a one-sided spring of 100 at gap 1 on mass
    1, a force `force` cos(W t) on mass 2, W = `w` [rad/s].  A force on coordinate j is participation_k =
    phi_k(j) with the base amplitude Z = `force`/W^2.
    """
    squares, shapes = np.linalg.eigh(np.array([[1.0, -1.0], [-1.0, 2.0]]))
    law, drive = LinearContact(stiffness=100.0), (w / (2.0 * np.pi), force / w**2)
    return modes_on_stop(np.sqrt(squares), 0.03 * squares, *shapes, law=law, gap=1.0, drive=drive)


def at_rest_on(model: ModalModel, law: LinearContact, load: float) -> tuple[ImpactOscillator, np.ndarray]:
    """The tip pressed on a stop without gap by `load` [N], and its displacements at rest."""
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=law), load=load * model.phi)
    whole = np.diag(model.omega**2) + law.stiffness * np.outer(model.phi, model.phi)
    return oscillator, np.linalg.solve(whole, load * model.phi)


def steady(oscillator: ImpactOscillator, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Modal displacement and velocity of the motion without wall."""
    if oscillator.drive is None:
        return np.zeros(oscillator.n_modes), np.zeros(oscillator.n_modes)
    w = oscillator.drive.angular_frequency
    turning = oscillator.drive.amplitude * oscillator.steady_response() * np.exp(1j * w * time)
    return turning.imag, (1j * w * turning).imag


def heights(oscillator: ImpactOscillator, displacement: np.ndarray) -> np.ndarray:
    """Of the tip over the stop [m]."""
    return displacement @ oscillator.model.phi - oscillator.stop.gap


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """Largest distance between two sets of multipliers, matched."""
    distance = np.abs(np.asarray(a)[:, None] - np.asarray(b)[None, :])
    return float(distance[linear_sum_assignment(distance)].max())
