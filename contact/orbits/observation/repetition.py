"""Two criteria for a settled motion: its points repeat, or its free motion can never reach the stop again.

**Repetition.** The orbit has period p if all coordinates of the last L points repeat those p strobes before
to a tolerance and the impacts of each strobe repeat exactly, p <= L.

**No impact any more.** The remaining free motion can only shrink (``contact.flight``).  The tip never meets
the stop again if

    |x_steady| + sum_k |phi_k| sqrt(u_k^2 + (u_k'/omega_k)^2)  <  gap.
"""

import numpy as np

from beam.parameters import require, require_array, require_whole, require_within
from contact.errors import NotPeriodic
from contact.flight.modal_flow import tip_bound
from contact.flight.motion import OMEGA
from contact.machine.compiled import kernel
from contact.maps.protocol import DifferentiableMap

RETURNS = 1e-6  # distance over the scale at which a state is back: settled motions reach 1e-9, chaos 1e-2


@kernel
def repetition(points, impacts, rows, stretch, tolerance):
    """The smallest p <= `stretch` with which the last `stretch` strobes repeat, or 0.

    `rows` of `points` and `impacts` are in use, at least 2 `stretch`.
    """
    for period in range(1, stretch + 1):
        same, i = True, rows
        while same and i > rows - stretch:
            i -= 1
            same, k = impacts[i] == impacts[i - period], 0
            while same and k < points.shape[1]:
                same, k = abs(points[i, k] - points[i - period, k]) <= tolerance, k + 1
        if same:
            return period
    return 0


def period_of(points: np.ndarray, impacts: np.ndarray, *, largest_period: int, tolerance: float) -> int:
    """The smallest p <= `largest_period` with which the last `largest_period` points repeat, or 0.

    `points`, shape (n_strobes, n_coordinates), and `impacts`, shape (n_strobes,), must hold at least
    2 * `largest_period` strobes.  `tolerance` is in the unit of the points.
    """
    stretch = require_whole("largest_period", largest_period, "strobes", low=0)
    given = require_array("points", points, "any unit", dimensions=2, words="rows of coordinates")
    rows = len(given)
    require(rows >= 2 * stretch, f"points has {rows} strobes; it must have {2 * stretch} or more")
    require(given.shape[1] > 0, f"points has shape {given.shape}; it must have one coordinate or more")
    counts = require_array("impacts", impacts, "[1]", shape=(rows,)).astype(np.int64)
    fine = require_within("tolerance", tolerance, "(the unit of the points)", low=0)
    return int(repetition(given.copy(), counts, rows, stretch, fine))


def require_orbit(strobed: DifferentiableMap, state, period: int) -> None:
    """NotPeriodic unless the motion from `state` is back after `period` steps, to `RETURNS` of the scale."""
    away = np.abs(strobed.orbit(state, period).points[-1] - strobed.coordinates(state)).max()
    if not away <= RETURNS * strobed.scale:
        words = f"after {period} periods it is {away:.3g} from the state, of a scale of {strobed.scale:g}"
        raise NotPeriodic(time=getattr(state, "time", 0.0), gap=0.0, velocity=0.0, detail=words)


@kernel
def free_for_good(motion, u, v):
    """Whether the free motion of the deviations (u, v) can never bring the tip to the stop."""
    left = motion.amplitude
    for k in range(motion.size):
        if not motion.modes[OMEGA, k] > 0.0:
            return False
        left += tip_bound(motion, k, u[k], v[k] / motion.modes[OMEGA, k])
    return left < -motion.level * (1.0 - 1e-12)
