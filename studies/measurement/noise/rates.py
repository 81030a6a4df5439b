"""When noise ends an orbit in a scan, by formulas: what `scans` finds by simulation.

**White noise next to a fold.**  The normal form (`places`) in m periods, eta' = mu - eta^2 with noise of
variance 2D, mu = K d/4, D = (K s nu/4)^2/2, d the distance to the fold, s the standard deviation, nu the
unevenness, has the mean time (Sigeti and Horsthemke, J. Stat. Phys. 54, 1217 (1989))

    T = 2 sqrt(pi/D) int_0^inf exp((mu v^2 - v^6/12)/D) dv,       rate = 1/(m T).

**Drift next to a fold.**  It is absorbed at the fold less `LAG` y_0, with (K/4) y_0 t_0^2 = 1 and
y_0^2 = s^2 m t_0/t_c, t_c in drive periods.

**Below grazing.**  A drift e touches when x + e > 0.  In white noise the peaks of the tip have the variance
S^2 and correlation R of neighbours, and pass the stop h above their mean at the rate
2 T(h/S, sqrt((1 - R)/(1 + R))), T Owen's function.

With a drift the density of e is carried along the whole scan by its Fokker-Planck equation with an absorbing
end, exactly in time: steps remember each other.  What ends in the second half of a waiting counts for the
next step, as in the scans.  Derivation: ``docs/theory/noise.md``.
"""

import math
from collections.abc import Callable

import numpy as np

from contact.orbits import strobe_covariance, strobe_derivatives
from studies.measurement.noise.places import Place
from studies.measurement.noise.scans import Protocol
from studies.physics.drive_noise import Array

LAG = 1.85  # minus the mean y at which eta' = y - eta^2 leaves, from far above: simulated, good to 0.003
SLOW = 500.0  # drive periods of correlation from which on a drift is slow: an orbit passes its fold in 100
CELLS = 10  # of the density in a standard deviation of the drift
PHASES = 4  # parts of a step at which a scan begins
WIDEST = 6.0  # standard deviations beyond which the drift is left out
BELOW = -0.01  # excess at which the motion without impacts is linearised: any below grazing

Law = tuple[Array, Array]
"""Excesses, and the probability of each to be the one at which the orbit ended."""


def mean_time(distance: float, place: Place, stability: float) -> float:
    """T of white noise, m periods, at the `distance` from the fold; infinite beyond 1e300."""
    mu = 0.25 * place.steepness * distance
    strength = 0.5 * (0.25 * place.steepness * stability * place.unevenness) ** 2
    peak = 4.0 / 3.0 * max(mu, 0.0) ** 1.5 / strength
    if peak > 690.0:
        return math.inf
    widest = 2.0 * math.sqrt(max(mu, 0.0)) + (480.0 * strength) ** (1.0 / 3.0)
    v = np.linspace(0.0, math.sqrt(widest), 4001)
    height = np.exp((mu * v**2 - v**6 / 12.0) / strength - peak)
    whole = v[1] * (height.sum() - 0.5 * height[0])
    return float(2.0 * math.sqrt(math.pi / strength) * whole * math.exp(peak))


def slipped_in_white_noise(place: Place, protocol: Protocol) -> Law:
    """Where p_m slips."""
    end, deviation = place.fold.excess, protocol.stability
    return of_rates(end, -1.0, protocol, lambda x: 1.0 / (place.m * mean_time(x - end, place, deviation)))


def of_rates(end: float, way: float, protocol: Protocol, rate: Callable[[float], float]) -> Law:
    """The law of a scan past `end`, rising or falling as `way`, in which `rate` is that of one period."""
    levels, found = [], []
    for phase in range(PHASES):
        steps = np.arange(protocol.steps) + (phase + 0.5) / PHASES
        x = end + way * (protocol.step * steps - protocol.reach)
        hazards = protocol.waiting * np.array([rate(each) for each in x])
        passed = np.cumsum(hazards) - 0.5 * hazards
        held = np.exp(-np.concatenate([[0.0], passed]))
        levels.append(x)
        found.append((held[:-1] - held[1:]) / PHASES)
    return np.concatenate(levels), np.concatenate(found)


def in_drift(end: float, way: float, protocol: Protocol, frequency_hz: float) -> Law:
    """The law of a scan in which the orbit ends where excess and drift together pass `end`."""
    from scipy.linalg import eigh_tridiagonal  # slow to import

    s, waiting = protocol.stability, protocol.waiting / (frequency_hz * protocol.correlation_s)
    fine = math.ceil(CELLS * protocol.step / s)
    width = protocol.step / fine
    jump, levels, found = (s / width) ** 2, [], []
    for phase in range(PHASES):
        first = protocol.reach - protocol.step * (phase + 0.5) / PHASES  # distance to the end
        x = first - protocol.step * np.arange(protocol.steps)
        # cells from the end inwards, up to `WIDEST` deviations; the end moves by `fine` cells a step
        count = math.ceil((WIDEST * s + first) / width)
        root = np.exp(-0.25 * ((-first + width * (np.arange(count) + 0.5)) / s) ** 2)
        density, held = root**2 / np.sum(root**2), [1.0]
        for level in range(protocol.steps):
            kept, inside = root[level * fine :], density[level * fine :]
            if kept.size < 3 or held[-1] < 1e-9:
                break
            # jumps between cells in detailed balance; the end is half a cell from the first
            ratio = kept[1:] / kept[:-1]
            leaving = np.append(ratio, 0.0) + np.append(2.0, 1.0 / ratio)
            values, vectors = eigh_tridiagonal(-jump * leaving, np.full(ratio.size, jump))
            parts = vectors.T @ (inside / kept)
            half, whole = (kept * (vectors @ (np.exp(t * values) * parts)) for t in (0.5 * waiting, waiting))
            held.append(float(half.sum()))
            density[level * fine :] = whole
        held += [0.0] * (protocol.steps + 1 - len(held))
        levels.append(end - way * x)
        found.append(-np.diff(held) / PHASES)
    return np.concatenate(levels), np.concatenate(found)


def touched_in_white_noise(place: Place, protocol: Protocol) -> Law:
    """Where p_1 of Eq. (1) is touched."""
    from scipy.special import owens_t  # slow to import

    strobed, s = place.strobed.at(BELOW), protocol.stability
    oscillator = strobed.oscillator
    w, decay = oscillator.driven.angular_frequency, 0.5 * float(oscillator.model.decay_rate[0])
    omega, height = float(oscillator.model.omega[0]), oscillator.stop.gap * (1.0 + BELOW)
    steady = strobed.coordinates(strobed.steady())
    peak = (math.atan2(steady[1] * omega / w, steady[0]) / w) % oscillator.period
    high = math.sqrt(omega**2 - decay**2)
    sine, fade = math.sin(high * peak) / high, math.exp(-decay * peak)
    # the peak is this of the deviation at the strobe, and this of the amplitude
    row = fade * np.array([math.cos(high * peak) + decay * sine, omega * sine])
    own = height - row @ steady
    matrix, pull = strobe_derivatives(strobed, strobed.steady(), 1)[0]
    spread = strobe_covariance(strobed, strobed.steady(), 1, deviation=s)[0]
    variance = row @ spread @ row + (own * s) ** 2
    together = (row @ matrix @ spread @ row + (row @ pull) * own * s**2) / variance
    alike = math.sqrt((1.0 - together) / (1.0 + together))
    size = math.sqrt(variance) / height
    return of_rates(0.0, 1.0, protocol, lambda x: 2.0 * owens_t(-x / size, alike) if x < 0.0 else 1.0)


def law_of(place: Place, protocol: Protocol, what: str) -> Law | None:
    """The law of `what`, "slipped" (p_m, on the way down) or "touched" (p_1, up); None if neither holds."""
    frequency, periods = place.frequency_hz, place.frequency_hz * protocol.correlation_s
    if not periods:
        return (slipped_in_white_noise if what == "slipped" else touched_in_white_noise)(place, protocol)
    if periods < SLOW:
        return None
    if what == "touched":
        return in_drift(0.0, 1.0, protocol, frequency)
    k = place.steepness
    unit = (16.0 * periods / (k**2 * place.m * protocol.stability**2)) ** 0.2
    return in_drift(place.fold.excess - LAG * 4.0 / (k * unit**2), -1.0, protocol, frequency)


def quantiles(law: Law, parts: tuple[float, ...]) -> list[float]:
    """Excesses below which these parts of a law lie."""
    order = np.argsort(law[0])
    weights = law[1][order] / law[1].sum()
    return [float(np.interp(part, np.cumsum(weights) - 0.5 * weights, law[0][order])) for part in parts]
