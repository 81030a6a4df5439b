"""Two criteria for a settled motion: its points repeat, or its free motion can never reach the stop again.

**Repetition.** The orbit has period p if all coordinates of the last L points repeat those p strobes before
to a tolerance and the impacts of each strobe repeat exactly, p <= L.

**No impact any more.** The remaining free motion can only shrink (``contact.flight``).  The tip never meets
the stop again if

    |x_steady| + sum_k |phi_k| sqrt(u_k^2 + (u_k'/omega_k)^2)  <  gap.
"""

import numpy as np

from beam.parameters import require, require_array
from contact.errors import NotPeriodic
from contact.flight.numbers import OMEGA
from contact.flight.tip import tip_bound
from contact.machine.compiled import kernel
from contact.maps.protocol import DifferentiableMap

RETURNS = 1e-6  # distance over the scale at which a state is back: settled motions reach 1e-9, chaos 1e-2


@kernel
def repetition(points, impacts, rows, strobes, tolerance):
    """The smallest p <= `strobes` with which the last `strobes` points repeat, or 0.

    `rows` of `points` and `impacts` are in use, at least 2 `strobes`.
    """
    for m in range(1, strobes + 1):
        same, i = True, rows
        while same and i > rows - strobes:
            i -= 1
            same, k = impacts[i] == impacts[i - m], 0
            while same and k < points.shape[1]:
                same, k = abs(points[i, k] - points[i - m, k]) <= tolerance, k + 1
        if same:
            return m
    return 0


def repeats_after(points: np.ndarray, impacts: np.ndarray, *, largest_m: int, tolerance: float) -> int:
    """The smallest p <= `largest_m` with which the last `largest_m` points repeat, or 0.

    `points`, shape (n_strobes, n_coordinates), and `impacts`, shape (n_strobes,), must hold at least
    2 * `largest_m` strobes.  `tolerance` is in the unit of the points.
    """
    given = require_array("points", points, "any unit", dimensions=2, words="rows of coordinates")
    rows, least = len(given), 2 * largest_m
    require(rows >= least, f"points has {rows} strobes; it must have {least} or more")
    require(given.shape[1] > 0, f"points has shape {given.shape}; it must have one coordinate or more")
    counts = require_array("impacts", impacts, "[1]", shape=(rows,)).astype(np.int64)
    return int(repetition(given.copy(), counts, rows, np.int64(largest_m), tolerance))


def require_orbit(strobed: DifferentiableMap, state, m: int) -> None:
    """NotPeriodic unless the motion from `state` is back after `m` steps, to `RETURNS` of the scale."""
    away = np.abs(strobed.orbit(state, m).points[-1] - strobed.coordinates(state)).max()
    if not away <= RETURNS * strobed.scale:
        words = f"after {m} periods it is {away:.3g} from the state, of a scale of {strobed.scale:g}"
        raise NotPeriodic(time=getattr(state, "time", 0.0), detail=words)


@kernel
def free_for_good(numbers, u, v):
    """Whether the free motion of the deviations (u, v) can never bring the tip to the stop."""
    left = numbers.amplitude
    for k in range(numbers.size):
        if not numbers.modes[OMEGA, k] > 0.0:
            return False
        left += tip_bound(numbers, k, u[k], v[k] / numbers.modes[OMEGA, k])
    return left < -numbers.level * (1.0 - 1e-12)
