"""Newton's impact law for any number of modes, and where its impacts accumulate.

The impulse of the stop acts on the tip alone, so that the modal velocities jump by

    v_k -> v_k - phi_k (1 + e) x' / sum_j phi_j^2,

which sends the tip velocity x' to -e x'.  After an impact that leaves the tip with velocity -w while it is
accelerated towards the wall with a > 0, the next flights last 2w/a, 2ew/a, ...: their sum 2w/(a(1 - e)) is
finite, and when a hop has become so low that its height drowns in rounding the rest of the sequence is taken
in one step.  Then the tip stays on the wall (``contact.linear_lanes``) until the force would pull.
"""

from __future__ import annotations

from contact.compiled import kernel

__all__ = ["accumulation_time", "lowest_hop", "newton_impact"]

LOWEST_HOP = 200.0
"""Height of a hop, in rounding bounds of the tip displacement, below which hops are summed, not computed: two
digits of the height are then still good.  See `lowest_hop` for laws close to e = 1."""


@kernel
def lowest_hop(restitution, rounding):
    """Height of the lowest hop that is computed [m], `rounding` the bound of the tip displacement's [m].

    A hop loses 2(1 - e) of its height, and rounding may move its end by as much as its bound: where that is
    not the smaller of the two, hops need not get lower, and may repeat for good.
    """
    return max(LOWEST_HOP, 1.0 / (1.0 - restitution)) * rounding


@kernel
def newton_impact(motion, v, approach, restitution):
    """Apply the impulse that turns the tip velocity `approach` into -`restitution` times itself."""
    impulse = (1.0 + restitution) * approach / motion.compliance
    for k in range(motion.phi.size):
        v[k] -= motion.phi[k] * impulse


@kernel
def accumulation_time(rebound, acceleration, restitution, rounding):
    """Time until accumulating impacts have come to rest [s], or -1 if the hop is still worth computing.

    `rebound` is the speed with which the tip leaves [m/s], `acceleration` its acceleration towards the wall
    [m/s^2] and `rounding` the rounding bound of the tip displacement [m].
    """
    if acceleration <= 0.0 or restitution >= 1.0:
        return -1.0
    if rebound * rebound > 2.0 * acceleration * lowest_hop(restitution, rounding):
        return -1.0
    return 2.0 * rebound / (acceleration * (1.0 - restitution))
