"""Start values of a fit, from the record.

Strobe points: of the orbits p_m of the given oscillator, m the repetition of the record, the one at the
record's drive; where there is none, or none like the record, parameters and approach speed are fitted
together, the drive amplitude allowed to be a little off, until one is close.

Displacement: at an impact the velocity jumps. Between two impacts, with one mode,

    x = A sin(w t) + B cos(w t) + exp(-c t/2) (C cos(2 pi t/T) + D sin(2 pi t/T)),

A and B the same everywhere: linear least squares for given T and c, which are varied if they are fitted. The
gap is the height at the corners, restitution and delay follow from the curves on both sides of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.optimize import least_squares

from beam import InvalidValue, Refusal
from contact import ContactError, ImpactOscillator, SingleImpactOrbit, State
from studies.measurement.identify.predictions import (
    PRIOR,
    Displacement,
    Prediction,
    Strobes,
    Transitions,
    family_of,
)
from studies.measurement.identify.records import Record
from studies.physics.parameters import parameters_of, with_values

Array = NDArray[np.float64]

LONGEST = 64
"""Longest period of an orbit that is looked for [drive periods]."""

ALIKE = 3.0
"""A record repeats after m rows if rows m apart differ by no more than this times the least difference."""

FLAT = 1e-3
"""Scatter over size of strobe points that are one and the same."""

CLOSE = 0.01
"""A start whose residuals are below this part of the record's own size needs no search."""

SIMILAR, TRIED = 0.1, 3
"""The same at which a search has failed; starts that are searched from."""

SPEEDS = np.geomspace(0.01, 0.5, 12)
"""Approach speeds that a search begins with, in units of 2 pi f gap."""

CORNER, LEVEL, FINE = 0.01, 2e-4, 81
"""Jump of the velocity over 2 pi f gap from which on a maximum of a displacement is an impact; part of the
height within which the tip rests on the stop; instants at which the curves of both sides are compared."""

WINDOW, DENSEST, ENOUGH = 0.08, 40, 100
"""Part of a drive period on either side that gives the velocity at an impact; least number of rows a period;
most rows that are used."""

SHARES, OF_CORNERS = np.linspace(1.0, 0.0, 5), ("gap", "restitution", "delay")
"""Places of the top between where the curves on both sides meet and the highest row, and what they give."""

STRETCHES, ROWS, SHORTEST = 8, 60, 0.1
"""Stretches between impacts, and rows of each, that give free period and decay rate; drive periods of the
shortest."""


def prediction_of(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str]
) -> tuple[Prediction, ImpactOscillator]:
    """The prediction of the rows, and the start of the fit; ValueError for a poor record."""
    if record.kind == "transitions":
        return Transitions(record), oscillator
    if record.kind == "strobe":
        return _strobes(record, oscillator, names)
    return _displacement(record, oscillator, names)


def repetition(record: Record) -> int:
    """The period of strobe points in drive periods; ValueError if they do not repeat or have no impact."""
    rows = record.observed[:, 0]
    most = min(LONGEST, len(rows) // 2)
    off = np.array([np.sqrt(np.mean((rows[m:] - rows[:-m]) ** 2)) for m in range(1, most + 1)])
    period = int(np.argmax(off <= ALIKE * off.min())) + 1
    if rows.std() < FLAT * np.abs(rows).max():
        raise InvalidValue("the strobe points stay where they are: there is no impact in the record")
    if off[period - 1] > SIMILAR * rows.std():
        raise InvalidValue(
            f"the record is too short, or its strobe points do not repeat: no period up to {most} rows"
        )
    if period == 1:
        raise InvalidValue("the strobe points repeat after one drive period: no sign of an impact")
    return period


def _strobes(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str]
) -> tuple[Strobes, ImpactOscillator]:
    period, size = repetition(record), float(record.observed[:, 0].std())
    if (told := period * record.observed.shape[1]) < len(names):
        raise InvalidValue(f"p{period} gives {told} numbers, which cannot tell {len(names)} parameters")

    def near(at: ImpactOscillator, most: float) -> Strobes | None:
        """The orbit at the drive of this oscillator, if it is off by less than this part of the record."""
        try:
            orbits = family_of(at, period).orbits(at.excess)
            if not orbits:
                return None
            found = Strobes(record, period, orbits[-1])
            off = (found.values(at, found.extra) - record.observed)[:, 0]
        except (ContactError, Refusal):
            return None
        return found if np.sqrt(np.mean(off**2)) < most * size else None

    found, begun = near(oscillator, CLOSE), oscillator
    if found is None:
        begun, orbit = _searched(record, oscillator, names, period)
        begun = orbit.oscillator if "amplitude" in names else begun
        found = near(begun, SIMILAR)
    if found is None:
        raise InvalidValue(
            f"no p{period} with one impact was found near the record: give better values of what is not "
            "fitted, or fit more"
        )
    return found, begun


def _searched(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str], period: int
) -> tuple[ImpactOscillator, SingleImpactOrbit]:
    """The oscillator and orbit p_m most like the record, its amplitude allowed to be a little off."""
    known, unit, kept = parameters_of(oscillator), oscillator.unit_speed, "amplitude" not in names
    own = [name for name in names if name != "amplitude"]
    sizes, scale = np.array([known[name].size for name in own]), record.units(CLOSE * oscillator.stop.gap)

    def orbit_at(unknowns: Array) -> tuple[ImpactOscillator, SingleImpactOrbit]:
        at = with_values(oscillator, dict(zip(own, (unknowns[:-1] * sizes).tolist(), strict=True)))
        return at, family_of(at, period).orbit(math.exp(unknowns[-1]) * unit)

    def off(unknowns: Array) -> Array:
        try:
            at, orbit = orbit_at(unknowns)
            rows = ((Strobes(record, period, orbit).of_orbit() - record.observed) / scale).ravel()
        except (ContactError, Refusal):
            return np.full(scale.size + 1, np.nan)
        drive = orbit.amplitude / at.driven.amplitude - 1.0
        return np.append(rows, kept * drive * math.sqrt(rows.size) / CLOSE)

    begun = np.array([known[name].value for name in own]) / sizes
    starts = [np.append(begun, math.log(part)) for part in SPEEDS]
    costs = np.array([np.sum(off(start) ** 2) for start in starts])
    best = [starts[i] for i in np.argsort(costs)[:TRIED] if np.isfinite(costs[i])]
    if not best:
        raise InvalidValue(
            f"the scene has no p{period} with one impact at {oscillator.driven.frequency:g} Hz"
        )
    found = [least_squares(off, start, max_nfev=30, x_scale="jac") for start in best]
    return orbit_at(min(found, key=lambda one: one.cost).x)


class Corner(NamedTuple):
    """An impact in a displacement: the last row before it, the first after it, and what the cubics through
    the rows on both sides give for height [m], restitution [1] and delay [s], shape (n_shares, 3)."""

    before: int
    after: int
    values: Array


def _corners(times: Array, x: Array, oscillator: ImpactOscillator, waits: bool) -> list[Corner]:
    """The impacts of a displacement: maxima at which its velocity jumps, after a wait or at once."""
    step = float(times[1] - times[0])
    width = max(5, round(WINDOW * oscillator.period / step))
    cubic = np.linalg.pinv(np.vander(np.arange(width) * step, 4))
    speed, found = oscillator.driven.angular_frequency * float(x.max()), list[Corner]()
    tops = np.flatnonzero((x == maximum_filter1d(x, 2 * width + 1)) & (x > 0.5 * x.max()))
    for i in tops[(tops >= width) & (tops < x.size - width)]:
        level = np.flatnonzero(x[i + 1 :] < x[i] - LEVEL * x.max())
        here, there = i - 1, i + 1 + (int(level[0]) if waits and level.size else 0)
        if there + width > x.size:
            continue
        back, ahead = cubic @ x[here - width + 1 : here + 1][::-1], cubic @ x[there : there + width]
        apart = times[there] - times[here]
        s = np.linspace(0.0, apart, FINE)
        left, right = np.polyval(back, -s), np.polyval(ahead, s - apart)
        meet = int(np.argmin(np.abs(left - right)))
        v_in, v_out = -np.polyval(np.polyder(back), -s), np.polyval(np.polyder(ahead), s - apart)
        if v_in[meet] - v_out[meet] < CORNER * speed:
            continue
        # the top lies between the highest row and where the curves meet, or is seen where the tip rests on it
        over = left[meet] - x[i] if there - here == 2 else 0.0
        values = []
        for top in x[i] + over * SHARES:
            met, gone = int(np.argmax(left >= top)), FINE - 1 - int(np.argmax(right[::-1] >= top))
            values.append((top, np.clip(-v_out[gone] / v_in[met], 0.0, 1.0), max(s[gone] - s[met], 0.0)))
        found.append(Corner(here, there, np.array(values)))
    return found


def _displacement(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str]
) -> tuple[Displacement, ImpactOscillator]:
    times, x = record.rows.T
    if (times[-1] - times[0]) < 2.0 * oscillator.period:
        raise InvalidValue("the record is too short: it must be two drive periods long at least")
    if (density := oscillator.period / (times[1] - times[0])) < DENSEST:
        raise InvalidValue(f"the record has {density:.3g} rows a drive period; it needs {DENSEST} at least")
    known = parameters_of(oscillator)
    thin = max(1, int(density / ENOUGH))  # a slow rebound hides in the noise of the next row
    corners = [
        one._replace(before=thin * one.before, after=thin * one.after)
        for one in _corners(times[::thin], x[::thin], oscillator, "delay" in known)
    ]
    if not corners:
        raise InvalidValue("there is no impact in the record")
    cuts = [0, *(one.after + 1 for one in corners)], [*(one.before for one in corners), x.size]
    stretches = [(a, b) for a, b in zip(*cuts, strict=True) if b - a > SHORTEST * density]
    rung = _rung(times, x, stretches, oscillator, names) if oscillator.n_modes == 1 else {}
    begin = stretches[0][0]
    near = [int(one.after) - begin for one in corners if one.before > begin]
    first = int(max([*near[:1], 2.5 * density]) + 0.5 * density)
    expected = sum(row < first for row in near)

    def tried(values: dict[str, float]) -> tuple[tuple[bool, float], Displacement, ImpactOscillator]:
        """Whether the first impacts are missed, and the misfit around them."""
        begun = with_values(oscillator, {name: values[name] for name in names if name in values})
        found = Displacement(record, begun, _start(times, x, stretches[0], begun), first)
        return found.misfit(begun, expected), found, begun

    law: dict[str, float] = {name: known[name].value for name in ("restitution", "delay") if name in known}
    medians = np.median([one.values for one in corners], axis=0)
    rows = [dict(zip(OF_CORNERS, row, strict=True)) for row in medians.tolist()]
    highest = {"gap": max(rows[0]["gap"], float(x.max()))}
    choices: list[dict[str, float]] = [rung | one | other for one in rows for other in (highest, law, {})]
    return min(map(tried, choices), key=lambda one: one[0])[1:]


def _rung(
    times: Array,
    x: Array,
    stretches: Sequence[tuple[int, int]],
    oscillator: ImpactOscillator,
    names: Sequence[str],
) -> dict[str, float]:
    """Free period, decay rate and drive amplitude of one mode, from between the impacts."""
    known, w = parameters_of(oscillator), oscillator.driven.angular_frequency
    free = [name for name in ("free_period", "decay_rate") if name in names]
    picked = [np.unique(np.linspace(a, b - 1, ROWS).astype(int)) for a, b in stretches[:STRETCHES]]
    rows, place = np.concatenate(picked), np.repeat(np.arange(len(picked)), [one.size for one in picked])
    t, y, age = times[rows], x[rows], times[rows] - np.array([times[one[0]] for one in picked])[place]
    matrix = np.zeros((t.size, 2 + 2 * len(picked)))
    matrix[:, :2] = np.column_stack([np.sin(w * t), np.cos(w * t)])

    def split(unknowns: Array) -> tuple[Array, Array]:
        """Residuals and coefficients; the first two coefficients belong to the steady motion."""
        given = dict(zip(free, unknowns.tolist(), strict=True))
        period, rate = (given.get(name, known[name].value) for name in ("free_period", "decay_rate"))
        free_motion = np.exp((2j * math.pi / period - 0.5 * rate) * age)
        matrix[np.arange(t.size), 2 + 2 * place] = free_motion.real
        matrix[np.arange(t.size), 3 + 2 * place] = free_motion.imag
        coefficients = np.linalg.lstsq(matrix, y, rcond=None)[0]
        return matrix @ coefficients - y, coefficients

    begun = np.array([known[name].value for name in free])
    best = least_squares(lambda u: split(u)[0], begun, x_scale=begun, max_nfev=20).x if free else begun
    values = dict(zip(free, best.tolist(), strict=True))
    response = abs(with_values(oscillator, values).tip_response())
    return values | {"amplitude": float(np.hypot(*split(best)[1][:2])) / response}


def _start(times: Array, x: Array, stretch: tuple[int, int], oscillator: ImpactOscillator) -> State:
    """The state at the first row of a stretch without impact, from its rows; other modes near rest."""
    model, (a, b) = oscillator.model, stretch
    rows = np.unique(np.linspace(a, b - 1, 4 * ROWS).astype(int))
    w, age = oscillator.driven.angular_frequency, times[rows] - times[a]
    steady = np.imag(
        oscillator.driven.amplitude * oscillator.steady_response() * np.exp(1j * w * times[rows, None])
    )
    turn = np.sqrt(np.maximum(model.omega**2 - (0.5 * model.decay_rate) ** 2, 1e-6 * model.omega**2))
    free = np.exp(np.outer(age, 1j * turn - 0.5 * model.decay_rate)) * model.phi
    matrix = np.hstack([free.real, free.imag])
    held = np.where(np.arange(model.n_modes) == 0, 0.0, np.abs(model.phi) / oscillator.stop.gap / PRIOR)
    # rows count as good to a ten-thousandth of the gap: a prior beside them
    scale = 1e4 / oscillator.stop.gap
    whole = np.vstack([scale * matrix, np.diag(np.tile(held, 2))])
    target = np.append(scale * (x[rows] - oscillator.tip(steady)), np.zeros(2 * model.n_modes))
    cos, sin = np.linalg.lstsq(whole, target, rcond=None)[0].reshape(2, -1)
    response = oscillator.driven.amplitude * oscillator.steady_response() * np.exp(1j * w * times[a])
    velocity = turn * sin - 0.5 * model.decay_rate * cos + w * response.real
    return State(displacement=cos + response.imag, velocity=velocity, time=float(times[a]))
