"""Frequency bands of Nordmark's map, in which p_m appears at grazing.

As rho -> 0- without delay, p_m with one impact is admissible for theta = 2 pi/(f T) - 2 pi j between

    upper frequency   theta = pi/m, hence f = 2m/((2m j + 1) T): no hysteresis, at any damping and tau
    lower frequency   sin((m-1) theta)/sin(theta) = -(gamma_impact/gamma) gamma^(m/2): x_{m-1} = 0

with j = 1 in the letter (`whole_turns`); for m = 2 the lower end is at pi.  The mode must oscillate.

Source: letter of 1996, Fig. 3 and text.  Derivation: ``docs/theory/map.md``.
"""

import math

from beam.parameters import record, require_whole, require_within
from contact.maps.nordmark import NordmarkMap, YLine
from contact.maps.nordmark_orbits import MOST_PERIODS


@record(eq=True)
class Band:
    """The drive frequencies at which the orbit p_m appears at grazing.

    Parameters
    ----------
    m : int
        Period of the orbit in drive periods.
    lower, upper : float
        Ends of the band [Hz].
    """

    m: int
    lower: float
    upper: float


def frequency_band(
    m: int,
    *,
    free_period: float,
    decay_rate: float,
    restitution: float,
    y_line: YLine = "corrected",
    whole_turns: int = 1,
) -> Band:
    """Return the band of drive frequencies in which p_m appears at grazing.

    Parameters
    ----------
    m : int
        Period of the orbit in drive periods, from 2 to 100 000.
    free_period : float
        Damped free period T of the mode [s].
    decay_rate : float
        Decay rate mu of the mode [1/s].
    restitution : float
        Restitution tau, from 0 to 1 [1].
    y_line : {"corrected", "printed"}, optional
        The reading of the line for y' after an impact, as for `NordmarkMap`.
    whole_turns : int, optional
        Integer part of 1/(f T), 1 in the letter.

    Returns
    -------
    Band
        The band with its ends [Hz].

    Raises
    ------
    TypeError
        If an argument is no number.
    ValueError
        If an argument is out of its range, or refused by `NordmarkMap.from_frequencies`.
    """
    m = require_whole("m", m, "drive periods", low=2, high=MOST_PERIODS)
    require_within("free_period", free_period, "s", above=0)
    require_whole("whole_turns", whole_turns, "turns", low=0)

    def frequency(angle: float) -> float:
        return 1.0 / (free_period * (whole_turns + angle / (2.0 * math.pi)))

    NordmarkMap.from_frequencies(  # wrong parameters are refused here
        drive_frequency=frequency(math.pi / (m - 0.5)),
        free_period=free_period,
        decay_rate=decay_rate,
        restitution=restitution,
        y_line=y_line,
    )
    ratio = restitution**2 if y_line == "corrected" else 1.0

    from scipy.optimize import brentq  # slow to import

    def excess_height(past: float) -> float:  # proportional to -x_{m-1}; `past` = (m - 1) theta - pi
        angle = (math.pi + past) / (m - 1)
        decay = math.exp(-0.5 * m * decay_rate / frequency(angle))
        return ratio * decay * math.sin(angle) - math.sin(past)

    lower = math.pi
    if m > 2:  # the sign changes before past = pi/2, where sin(theta) < 1; 1e-15 rad is the rounding of theta
        lower = (math.pi + float(brentq(excess_height, 0.0, 0.5 * math.pi, xtol=1e-15))) / (m - 1)
    return Band(m=m, lower=frequency(lower), upper=frequency(math.pi / m))
