"""`Motion`: the numbers of one impact oscillator, as kernels see them.

All that flights, touches and orbits need stands in one container: scalars, and one table with the modes as
columns, filled up to a multiple of eight with modes that stay zero, so that a processor carries several in
one instruction.  (A table instead of a dozen arrays: to hand those on to a kernel takes several times as long
as to carry eight modes.)  Its equations are those of ``contact.flight.modal_flow``.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from contact.flight.elementary import square_root, two_product
from contact.machine.compiled import kernel
from contact.machine.vector_loops import LANES

DECAY, SQUARE, WEIGHT, LOAD, DAMPED, LOW, OMEGA, SLOWNESS, SHORTNESS, SINE, COSINE, OFFSET = range(12)
"""Rows of the table of modes: c, omega^2, phi, g of the modes of zero frequency, d = sqrt|D| as a sum of two,
omega, 1/omega (or zero), 1/max(omega, c/2) (or the period), S, C, g/omega^2.  The first four are those that
``contact.machine.vector_loops`` counts on."""


class Motion(NamedTuple):
    """The numbers of an oscillator.

    modes : ndarray, shape (12, m)
        The table; m is the number of modes, filled up to a multiple of eight.
    size : int
        Number of modes.
    level : float
        Static tip displacement minus gap [m].
    tip_sine, tip_cosine, amplitude : float
        Sums of phi S and phi C, and the amplitude of the steady tip motion [m].
    drive, period, gap, compliance : float
        w [rad/s], drive period [s], gap [m], sum of phi^2 [1/kg].
    steady_energy : float
        Sum of (w S)^2 + (w C)^2: twice the scale of the energy of the steady motion [J].
    law, number0, number1 : int, float, float
        Code of the contact law and its numbers.
    plain : bool
        Whether all modes are under-damped and without load.
    phase_rate, fastest : float
        Largest d, and largest of w, omega and c [rad/s].
    table : ndarray, shape (5, n)
        The law's functions of the approach speed, sampled.
    """

    modes: np.ndarray
    size: int
    level: float
    tip_sine: float
    tip_cosine: float
    amplitude: float
    drive: float
    period: float
    gap: float
    compliance: float
    steady_energy: float
    law: int
    number0: float
    number1: float
    plain: bool
    phase_rate: float
    fastest: float
    table: np.ndarray

    def row(self, row: int) -> np.ndarray:
        """A row of the table, shape (n_modes,)."""
        return self.modes[row, : self.size]

    @property
    def omega(self) -> np.ndarray:
        """omega [rad/s], shape (n_modes,)."""
        return self.row(OMEGA)

    @property
    def decay(self) -> np.ndarray:
        """c [1/s], shape (n_modes,)."""
        return self.row(DECAY)

    @property
    def phi(self) -> np.ndarray:
        """phi [kg^-0.5], shape (n_modes,)."""
        return self.row(WEIGHT)

    def tip(self, values: np.ndarray) -> np.ndarray:
        """What modal values (n_modes,) or (n_modes, n) come to at the tip, the sum of phi_k times them."""
        return self.phi @ values

    def most_at_tip(self, sizes: np.ndarray) -> float:
        """The most that modal values of these `sizes` can come to at the tip: as `tip`, signs left out."""
        return float(np.abs(self.phi) @ np.abs(sizes))

    def mobility(self, inertia: np.ndarray) -> float:
        """Velocity of the tip per impulse on it, sum phi^2/`inertia`, (n_modes,) [1/kg]."""
        return float(np.sum(self.phi**2 / inertia))

    def least_change(self, reach: float | np.ndarray) -> np.ndarray:
        """The least change of the modes that moves the tip by `reach`, phi reach/sum phi^2, (n_modes, ...): a
        push of the stop makes no other."""
        return np.multiply.outer(self.phi, np.asarray(reach) / self.compliance)


def motion_of(
    omega: np.ndarray,
    decay: np.ndarray,
    phi: np.ndarray,
    *,
    law: Any,
    gap: float,
    drive: float = 0.0,
    period: float = 1.0,
    response: np.ndarray | None = None,
    load: np.ndarray | None = None,
) -> Motion:
    """The numbers of an oscillator.

    Parameters
    ----------
    omega, decay, phi : array_like, shape (n_modes,)
    law : ContactLaw
        Its `code`, `numbers` and `table` are read.
    gap, drive, period : float
        [m], w [rad/s], [s].
    response : ndarray of complex, shape (n_modes,), optional
        S + iC [m kg^0.5].
    load : ndarray, shape (n_modes,), optional
        g [N kg^-0.5].
    """
    omega, decay, phi = (np.array(x, dtype=float) for x in (omega, decay, phi))
    n = omega.size
    response = np.zeros(n, dtype=complex) if response is None else np.asarray(response)
    load = np.zeros(n) if load is None else np.asarray(load)
    stiff = omega > 0
    offset = np.where(stiff, load / np.where(stiff, omega, 1.0) ** 2, 0.0)
    pairs = np.array([damped_frequency(x, c) for x, c in zip(omega, decay, strict=True)]).reshape(n, 2)
    modes = np.zeros((12, (n + LANES - 1) // LANES * LANES))
    modes[DAMPED] = 1.0
    modes[DECAY, :n], modes[SQUARE, :n], modes[WEIGHT, :n] = decay, omega * omega, phi
    modes[LOAD, :n], modes[OFFSET, :n] = np.where(stiff, 0.0, load), offset
    modes[DAMPED, :n], modes[LOW, :n], modes[OMEGA, :n] = pairs[:, 0], pairs[:, 1], omega
    modes[SINE, :n], modes[COSINE, :n] = response.real, response.imag
    top = np.maximum(omega, 0.5 * decay)
    modes[SLOWNESS, :n] = np.where(stiff, 1.0 / np.where(stiff, omega, 1.0), 0.0)
    modes[SHORTNESS, :n] = np.where(top > 0, 1.0 / np.where(top > 0, top, 1.0), period)
    plain = bool(np.all((pairs[:, 0] > 0) & (omega > 0.5 * decay) & (modes[LOAD, :n] == 0)))
    tip = complex(phi @ response)
    numbers = law.numbers
    return Motion(
        modes=modes,
        size=n,
        level=float(phi @ offset) - float(gap),
        tip_sine=tip.real,
        tip_cosine=tip.imag,
        amplitude=math.hypot(tip.real, tip.imag),
        drive=float(drive),
        period=float(period),
        gap=float(gap),
        compliance=float(phi @ phi),
        steady_energy=float(drive**2 * np.sum(np.abs(response) ** 2)),
        law=int(law.code),
        number0=float(numbers[0]),
        number1=float(numbers[1]),
        plain=plain,
        phase_rate=float(pairs[:, 0].max()),
        fastest=float(max(drive, omega.max(), decay.max())),
        table=np.asarray(law.table),
    )


@kernel
def with_drive(motion, factor):
    """The same oscillator at `factor` times its base amplitude."""
    modes = motion.modes.copy()
    for k in range(motion.size):
        modes[SINE, k] *= factor
        modes[COSINE, k] *= factor
    m = motion
    return Motion(
        modes,
        m.size,
        m.level,
        m.tip_sine * factor,
        m.tip_cosine * factor,
        m.amplitude * abs(factor),
        m.drive,
        m.period,
        m.gap,
        m.compliance,
        m.steady_energy * factor * factor,
        m.law,
        m.number0,
        m.number1,
        m.plain,
        m.phase_rate,
        m.fastest,
        m.table,
    )


@kernel
def damped_frequency(omega, decay):
    """sqrt(|omega^2 - (c/2)^2|) as a sum of two doubles [rad/s]."""
    half = 0.5 * decay
    p, ep = two_product(omega, omega)
    r, er = two_product(half, half)
    d = p - r
    back = d - p
    return square_root(d, ((p - (d - back)) + (-r - back)) + (ep - er))  # with the rounding error (Knuth)


def single_mode(motion: Motion, k: int) -> Motion:
    """The same steady tip motion with only mode `k` free."""
    modes = np.zeros((len(motion.modes), LANES))
    modes[DAMPED] = 1.0
    modes[:, 0] = motion.modes[:, k]
    damped, omega, load = modes[DAMPED, 0], modes[OMEGA, 0], modes[LOAD, 0]
    plain = bool(damped > 0.0 and omega > 0.5 * modes[DECAY, 0] and load == 0.0)
    return motion._replace(modes=modes, size=1, plain=plain, phase_rate=float(damped))
