"""The beam: time per drive period and per collision against modes, law, excess and tolerance.

At 21.50 Hz and excess 0.013 (the letter's Fig. 4) the beam settles on p4 with one collision; the same number
of periods without a touch, at excess -0.02, tells the collision from the rest.  A tolerance is heyoka's: the
package has none, its contacts are followed to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from beam import ModalModel
from contact.integrators import method_for
from contact.simulation import simulate
from contact.stroboscope import StroboscopicMap
from studies.instruments.benchmarks.floor import carry, flows_of
from studies.instruments.benchmarks.timing import in_turns
from studies.instruments.oscillators import beam_of
from studies.instruments.peers import HeyokaTaylor
from studies.instruments.scene import Scene
from studies.instruments.work_precision.errors import collision_errors, missed_crossings, yardstick_of
from studies.instruments.work_precision.problems import Problem

__all__ = ["BELOW", "EXCESS", "FREQUENCY", "beam_rows", "measured_errors", "slope_of"]

FREQUENCY, EXCESS, BELOW = 21.50, 0.013, -0.02
SETTLING = 1000


def beam_rows(
    scene: Scene, model: ModalModel, law: str, modes: int, *, quick: bool, peer_tolerance: float | None,
    excess: float = EXCESS,
) -> list[dict[str, Any]]:  # fmt: skip
    """The rows of one number of modes: the package, the floor and, with a tolerance, heyoka."""
    count, theirs = (200, 8) if quick else (2000, 40)
    oscillator = beam_of(scene.replace({"contact.law": law}), FREQUENCY, model.truncated(modes))
    strobed = StroboscopicMap(oscillator=oscillator.with_excess(excess))
    free = StroboscopicMap(oscillator=oscillator.with_excess(BELOW))
    state = strobed.orbit(strobed.steady(), SETTLING).end
    impacts = strobed.orbit(state, count).impacts.sum() / count
    flow, u, v = flows_of(oscillator), np.full(modes, 1e-4), np.full(modes, 1e-4)
    runs: dict[str, Callable[[], object]] = {
        "grazing-spring": lambda: strobed.orbit(state, count),
        "without a touch": lambda: free.orbit(free.steady(), count),
        "floor": lambda: carry(flow, np.ones(modes), 1.0, u, v, count),
    }
    length = dict.fromkeys(runs, count)
    if peer_tolerance is not None:
        peer = HeyokaTaylor(tolerance=peer_tolerance)
        runs["heyoka"] = lambda: simulate(strobed.oscillator, state, periods=theirs, method=peer)
        length["heyoka"] = theirs
    spent = {tool: 1e6 * s / length[tool] for tool, s in in_turns(runs, 3 if quick else 7).items()}
    collision = (spent["grazing-spring"] - spent["without a touch"]) / impacts if impacts else None
    return [
        {
            "case": f"beam, {law} contact" + (", no touch" if tool == "without a touch" else ""),
            "tool": "grazing-spring" if tool == "without a touch" else tool, "modes": modes, "law": law,
            "frequency_hz": FREQUENCY, "us_per_period": each, "error": None, "missed": None,
            "excess": BELOW if tool == "without a touch" else excess,
            "tolerance": peer_tolerance if tool == "heyoka" else None,
            "impacts_per_period": float(impacts) if tool in ("grazing-spring", "heyoka") else 0.0,
            "us_per_collision": collision if tool == "grazing-spring" else None,
        }
        for tool, each in spent.items()
    ]  # fmt: skip


def measured_errors(
    problem: Problem, peer_tolerances: Sequence[float]
) -> dict[float | None, tuple[float, float | None]]:
    """Error of the mode-1 state after a collision against extended precision, and share of crossings missed:
    for the package's method of the law (None) and for heyoka at each of `peer_tolerances`."""
    yardstick = yardstick_of(problem)
    tools: dict[float | None, Any] = {None: method_for(problem.oscillator.stop.law.code)}
    tools |= {tolerance: HeyokaTaylor(tolerance=tolerance) for tolerance in peer_tolerances}
    found: dict[float | None, tuple[float, float | None]] = {}
    for tolerance, method in tools.items():
        error = collision_errors(yardstick, method)["error"]
        assert error is not None
        found[tolerance] = (error, missed_crossings(yardstick, method)["missed"])
    return found


def slope_of(modes: list[int], microseconds: list[float]) -> float:
    """Exponent of the growth of the cost between the two largest numbers of modes."""
    (n0, n1), (t0, t1) = modes[-2:], microseconds[-2:]
    return float(np.log(t1 / t0) / np.log(n1 / n0))
