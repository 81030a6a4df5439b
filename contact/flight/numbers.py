"""`Numbers`: the numbers of one impact oscillator, as kernels see them.

One container holds all that flights, touches and orbits need: scalars, and one table with the modes as
columns.  The table is filled up to a multiple of eight with modes that stay zero, so that a processor handles
several in one instruction.  (Passing a dozen arrays to a kernel would take several times as long as
propagating eight modes.)  The equations stand in ``contact.flight.modal_flow``.

An oscillator with several stops has one `Numbers` too, in which their tables are stacked.  Each stop sees the
same modes with weights and numbers of its own, and `seen_from` gives the `Numbers` as one of them sees it.
Kernels of flights, touches and laws take such a view; only loops that choose between stops take the stack.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from contact.flight.elementary import square_root, two_product
from contact.machine.compiled import inlined, kernel
from contact.machine.vector_loops import LANES

DECAY, SQUARE, WEIGHT, LOAD = range(4)
DAMPED, DAMPED_LOW, OMEGA, INVERSE_OMEGA, TIME_SCALE, SINE, COSINE, OFFSET = range(4, 12)
"""Rows of the table of modes: c, omega^2, phi, g of the modes of zero frequency, d = sqrt|D| as a sum of two
doubles, omega, 1/omega (or zero), 1/max(omega, c/2) (or the period), S, C, g/omega^2.  The loops of
``contact.machine.vector_loops`` use the first four."""

NUMBERS = 12
"""In a stack, the row after the rows of a stop, which holds `_OWN`.  One more row holds law, numbers, and
where in the row `Numbers.table` its own table begins, with the numbers of its rows and columns.  It also says
whether stops that are met together act one after the other."""
STACKED = 14  # rows of the table for each of several stops

_OWN = "level", "tip_sine", "tip_cosine", "amplitude", "gap", "inverse_mass"


class Numbers(NamedTuple):
    """The numbers of an oscillator, as one stop sees them."""

    modes: np.ndarray  # the table, shape (12, m): m is the number of modes, filled up to a multiple of eight
    tip_sine: float  # sum of phi S [m]
    tip_cosine: float  # sum of phi C [m]
    amplitude: float  # of the steady tip motion [m]
    steady_energy: float  # sum of (w S)^2 + (w C)^2: twice the scale of the energy of the steady motion [J]
    size: int  # number of modes
    level: float  # static tip displacement minus gap [m]
    drive: float  # w [rad/s]
    period: float  # drive period [s]
    gap: float  # [m]
    inverse_mass: float  # sum of phi^2 [1/kg]
    law: int  # code of the contact law
    number0: float  # the numbers of the law
    number1: float
    all_underdamped: bool  # whether all modes are under-damped and without load
    phase_rate: float  # largest d [rad/s]
    fastest: float  # largest of w, omega and c [rad/s]
    table: np.ndarray  # more numbers of the law, in two dimensions, as its file reads them

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

    @property
    def steady(self) -> np.ndarray:
        """S, C and g/omega^2 [m kg^0.5], shape (3, n_modes)."""
        return self.modes[SINE : OFFSET + 1, : self.size]

    def tip(self, values: np.ndarray) -> np.ndarray:
        """The sum of phi_k times modal values, of shape (n_modes,) or (n_modes, n)."""
        return self.phi @ values

    def most_at_tip(self, sizes: np.ndarray) -> float:
        """The largest tip sum of modal values of these `sizes`, whatever their signs."""
        return float(np.abs(self.phi) @ np.abs(sizes))

    def mobility(self, inertia: np.ndarray) -> float:
        """Velocity of the tip per impulse on it, sum phi^2/`inertia`, (n_modes,) [1/kg]."""
        return float(np.sum(self.phi**2 / inertia))

    def least_change(self, displacement: float | np.ndarray) -> np.ndarray:
        """The least change of the modes that moves the tip by `displacement` d, phi d/sum phi^2, shape
        (n_modes, ...); an impulse of the stop changes the modes in this way."""
        return np.multiply.outer(self.phi, np.asarray(displacement) / self.inverse_mass)


def numbers_of(
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
) -> Numbers:
    """The numbers of an oscillator with these omega, c, phi, `gap` [m], `drive` w [rad/s] and `period` [s].

    `code`, `numbers` and `table` of the `law` are read.  `response` is S + iC [m kg^0.5], complex, and `load`
    is g [N kg^-0.5], both of shape (n_modes,).
    """
    omega, decay, phi = (np.array(x, dtype=float) for x in (omega, decay, phi))
    n = omega.size
    response = np.zeros(n, dtype=complex) if response is None else np.asarray(response)
    load = np.zeros(n) if load is None else np.asarray(load)
    stiff, top = omega > 0, np.maximum(omega, 0.5 * decay)
    offset = np.divide(load, omega**2, out=np.zeros(n), where=stiff)
    inverse = np.divide(1.0, omega, out=np.zeros(n), where=stiff)
    time = np.divide(1.0, top, out=np.full(n, float(period)), where=top > 0)
    high, low = np.array([damped_frequency(x, c) for x, c in zip(omega, decay, strict=True)]).reshape(n, 2).T
    drift = np.where(stiff, 0.0, load)
    modes = np.zeros((12, (n + LANES - 1) // LANES * LANES))
    modes[DAMPED] = 1.0
    modes[:SINE, :n] = decay, omega**2, phi, drift, high, low, omega, inverse, time
    modes[SINE:, :n] = response.real, response.imag, offset
    all_underdamped = bool(np.all((high > 0) & (omega > 0.5 * decay) & (drift == 0)))
    tip = complex(phi @ response)
    return Numbers(
        modes=modes,
        size=n,
        level=float(phi @ offset) - float(gap),
        tip_sine=tip.real,
        tip_cosine=tip.imag,
        amplitude=math.hypot(tip.real, tip.imag),
        drive=float(drive),
        period=float(period),
        gap=float(gap),
        inverse_mass=float(phi @ phi),
        steady_energy=float(drive**2 * np.sum(np.abs(response) ** 2)),
        law=int(law.code),
        number0=float(law.numbers[0]),
        number1=float(law.numbers[1]),
        all_underdamped=all_underdamped,
        phase_rate=float(high.max()),
        fastest=float(max(drive, omega.max(), decay.max())),
        table=np.asarray(law.table),
    )


def stacked(views: Sequence[Numbers], sequential: bool) -> Numbers:
    """The numbers of an oscillator with several stops, from those that each of them sees.

    `sequential`: whether stops that are met at one instant act one after the other.
    """
    blocks, tables, first = [], [], 0
    for view in views:
        own = np.zeros((STACKED - NUMBERS, view.modes.shape[1]))
        own[0, : len(_OWN)] = [getattr(view, name) for name in _OWN]
        own[1, :7] = view.law, view.number0, view.number1, first, *view.table.shape, sequential
        first += view.table.size
        blocks.append(np.concatenate((view.modes, own)))
        tables.append(view.table.ravel())
    return views[0]._replace(modes=np.concatenate(blocks), table=np.concatenate(tables)[None])


@inlined
def stops_of(numbers):
    """The number of stops."""
    return max(numbers.modes.shape[0] // STACKED, 1)


def _seen_from(numbers, j):
    """The motion as the stop of number `j` in a stack of several sees it."""
    top = STACKED * j
    own, code = numbers.modes[top + NUMBERS], numbers.modes[top + NUMBERS + 1]
    first, rows, columns = int(code[3]), int(code[4]), int(code[5])
    modes, steady = numbers.modes[top : top + NUMBERS], (own[1], own[2], own[3])
    law = int(code[0]), code[1], code[2]
    table = numbers.table[0][first : first + rows * columns].reshape(rows, columns)
    shared, drive, speeds = numbers[4:6], numbers[7:9], numbers[14:17]  # the same for every stop
    return Numbers(modes, *steady, *shared, own[0], *drive, own[4], own[5], *law, *speeds, table)


seen_from = inlined(_seen_from)


def views_of(numbers: Numbers) -> list[Numbers]:
    """The motion as each of its stops sees it."""
    count = len(numbers.modes) // STACKED
    return [_seen_from(numbers, j) for j in range(count)] if count else [numbers]


@kernel
def with_drive(numbers, factor):
    """The same oscillator with one stop at `factor` times its base amplitude."""
    modes = numbers.modes.copy()
    for k in range(numbers.size):
        modes[SINE, k] *= factor
        modes[COSINE, k] *= factor
    sine, cosine = numbers.tip_sine * factor, numbers.tip_cosine * factor
    amplitude, energy = numbers.amplitude * abs(factor), numbers.steady_energy * factor * factor
    return Numbers(modes, sine, cosine, amplitude, energy, *numbers[5:])


@kernel
def damped_frequency(omega, decay):
    """sqrt(|omega^2 - (c/2)^2|) as a sum of two doubles [rad/s]."""
    half = 0.5 * decay
    p, ep = two_product(omega, omega)
    r, er = two_product(half, half)
    d = p - r
    back = d - p
    return square_root(d, ((p - (d - back)) + (-r - back)) + (ep - er))  # with the rounding error (Knuth)


def with_only_mode(numbers: Numbers, k: int) -> Numbers:
    """The oscillator with the same steady tip motion and only mode `k` free."""
    modes = np.zeros((len(numbers.modes), LANES))
    modes[DAMPED] = 1.0
    modes[:, 0] = numbers.modes[:, k]
    damped, omega, load = modes[DAMPED, 0], modes[OMEGA, 0], modes[LOAD, 0]
    all_underdamped = bool(damped > 0.0 and omega > 0.5 * modes[DECAY, 0] and load == 0.0)
    return numbers._replace(modes=modes, size=1, all_underdamped=all_underdamped, phase_rate=float(damped))
