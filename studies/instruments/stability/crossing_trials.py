"""Who is tried on planted crossings: every method of the package, and every outside solver installed.

Fixed steps are a hundredth of the period for one mode and 0.5/omega_max for six; solvers with an error
control have one tolerance, and the spacing of their looks around the peak is measured in flights that meet
nothing.  Units: SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from contact.integrators import INTEGRATORS, CentralDifference, Integrator
from contact.laws import NEWTON
from contact.simulation import simulate
from studies.instruments.peers import HeyokaTaylor, ScipyMethod, SundialsCvode, available, lineup
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.stability.planted_crossings import (
    Swing,
    half_missed,
    half_missed_by_percussions,
    invented_by_percussions,
    share_missed,
    share_missed_by_percussions,
    spacings_of,
)

__all__ = ["MODES", "TOLERANCE", "Trial", "swings", "trials"]

TOLERANCE = 1e-8
MODES = 6
RINGING = 0.2
"""Part of the peak that the modes above the first make up [1]."""

LOOKED_AT = 12
"""Flights in which the spacing of the looks around the peak is measured."""

POINTS = (24, 96)
"""Samples per period of the lowest mode for the method that samples exact flights."""

QUICK = ("scipy DOP853", "heyoka Taylor", "CVODE Adams")
Peer = ScipyMethod | HeyokaTaylor | SundialsCvode


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A method to try: its label, the panel that shows it ("" for none), and the spacings of its looks [s];
    none for a method that searches between its steps."""

    label: str
    panel: str
    method: Integrator
    spacings: np.ndarray

    @property
    def percussions(self) -> bool:
        """Whether it acts by percussions at its grid points."""
        return self.panel == "step" and self.method.laws == (NEWTON,) and self.spacings.size > 0

    def half(self, pace: float) -> float | None:
        """Theory: overshoot over gap at which half the crossings are missed."""
        if not self.spacings.size:
            return None
        if self.percussions:
            return half_missed_by_percussions(float(self.spacings[0]), pace)
        return half_missed(self.spacings, pace)

    def share(self, overshoot: np.ndarray, pace: float) -> np.ndarray:
        """Theory: share of crossings missed; NaN where there is none."""
        if not self.spacings.size:
            return np.full(overshoot.size, np.nan)
        if self.percussions:
            return share_missed_by_percussions(overshoot, float(self.spacings[0]), pace)
        return share_missed(overshoot, self.spacings, pace)

    def invented(self, pace: float) -> float | None:
        """Theory: undershoot over gap down to which touches are invented."""
        if self.percussions:
            return invented_by_percussions(float(self.spacings[0]), pace)
        if self.label == CentralDifference.name:
            return float((pace * self.spacings[0]) ** 2 / 8.0)
        return None


def swings(scene: Scene) -> dict[str, Swing]:
    """The motions with a planted crossing: the first mode of the scene, and its first six."""
    model, gap = model_of(scene), scene.stop.gap_m
    period = 2.0 * math.pi / float(model.omega[0])
    several = min(MODES, model.omega.size)
    height = np.full(several, RINGING / max(1, several - 1))
    height[0] = 1.0 - float(height[1:].sum())
    return {
        "one": Swing(
            omega=model.omega[:1], phi=model.phi[:1], height=np.ones(1), gap=gap,
            lead=0.6 * period, spread=0.25 * period, tail=0.4 * period,
        ),
        # the fast modes are in step at the peak alone: the next highest one is at 0.83 gap
        "many": Swing(
            omega=model.omega[:several], phi=model.phi[:several], height=height, gap=gap,
            lead=0.05 * period, spread=0.02 * period, tail=0.02 * period,
        ),
    }  # fmt: skip


def _of_package(kind: type[Integrator], step: float) -> list[Trial]:
    """A method of the package: exact, with a time step, or with samples of exact flights."""
    if kind.certified:
        return [Trial(label=kind.name, panel="exact", method=kind(), spacings=np.empty(0))]
    known = {field.name for field in fields(kind)}  # type: ignore[arg-type]
    if "points" in known:
        # turning points between the samples are looked at as well, so that the spacing is not all
        return [
            Trial(
                label=f"{kind.name}, {points} points", panel="step", spacings=np.empty(0),
                method=kind(points=points),  # type: ignore[call-arg]
            )
            for points in POINTS
        ]  # fmt: skip
    given = {name: value for name, value in {"step": step, "rho": 0.8}.items() if name in known}
    return [Trial(label=kind.name, panel="step", method=kind(**given), spacings=np.array([step]))]


def _looks(peer: Peer, swing: Swing) -> np.ndarray:
    """Spacings of the looks of an outside solver around the peak [s]; none if it does not sample."""
    if isinstance(peer, HeyokaTaylor):
        return np.empty(0)
    looks: list[float] = []
    watched = replace(peer, looks=looks)
    oscillator = swing.oscillator(watched)

    def fly(lead: float) -> object:
        return simulate(oscillator, swing.start(-0.01, lead), duration=lead + swing.tail, method=watched)

    return spacings_of(looks, swing, fly, LOOKED_AT)


def trials(swing: Swing, *, quick: bool = False) -> list[Trial]:
    """Every method of the package and every outside solver installed."""
    period = 2.0 * math.pi / float(swing.omega[0])
    step = min(0.01 * period, 0.5 / float(swing.omega.max())) * (2.0 if quick else 1.0)
    found = [trial for kind in INTEGRATORS.values() for trial in _of_package(kind, step)]
    peers = lineup(TOLERANCE)
    chosen: dict[str, Any] = {name: peers[name] for name in (QUICK if quick else peers) if name in peers}
    if not quick:
        chosen["scipy DOP853, 1e-12"] = ScipyMethod(solver="DOP853", tolerance=1e-12)
    if "heyoka" in available():
        chosen["heyoka Taylor, 1e-15"] = HeyokaTaylor(tolerance=1e-15)
    for name, peer in chosen.items():
        panel = "" if name == "scipy DOP853, 1e-12" else "control"
        found.append(Trial(label=name, panel=panel, method=peer, spacings=_looks(peer, swing)))
    return found
