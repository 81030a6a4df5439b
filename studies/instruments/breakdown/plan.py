"""How finely a run of Fig. 5 looks: steps of the scans, drive periods at each, cells of the search."""

from __future__ import annotations

from dataclasses import dataclass

from studies.instruments.command_line import Request
from studies.published import SETTLE_CYCLES

__all__ = [
    "FACTORS",
    "LOCAL_RESTITUTIONS",
    "MASSES_KG",
    "Plan",
    "QUICK_FACTORS",
    "QUICK_LOCAL",
    "QUICK_MASSES_KG",
    "RESTITUTIONS",
    "plan_of",
]

RESTITUTIONS = (0.0, 0.05, 0.06, 0.075, 0.1)
MASSES_KG = tuple(
    m / 1000 for m in (3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0, 5.5, 6.0, 6.5, 7.0, 8.0)
)
FACTORS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 8.0)
LOCAL_RESTITUTIONS = (1.0, 0.7)
QUICK_MASSES_KG, QUICK_FACTORS, QUICK_LOCAL = (0.0035, 0.004), (1.0, 2.0), (1.0,)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How finely a run looks."""

    below: int
    above: int
    cycles: int
    early: bool
    masses: tuple[float, ...]
    factors: tuple[float, ...]
    local: tuple[float, ...]
    restitutions: tuple[float, ...]


def plan_of(request: Request) -> Plan:
    """The plan of a quick, a usual or a full run."""
    full = bool(request.options.full)
    if request.quick:
        return Plan(
            below=21,
            above=10,
            cycles=SETTLE_CYCLES if full else 500,
            early=not full,
            masses=QUICK_MASSES_KG,
            factors=QUICK_FACTORS,
            local=QUICK_LOCAL,
            restitutions=(0.05, 0.1),
        )
    return Plan(
        below=81,
        above=41,
        cycles=SETTLE_CYCLES if full else 2000,
        early=not full,
        masses=MASSES_KG,
        factors=FACTORS,
        local=LOCAL_RESTITUTIONS,
        restitutions=RESTITUTIONS,
    )
