"""The map over a drive period of a spring with several stops, for studies that settle on an orbit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact import ImpactOscillator, State, StrobedOrbit, simulate


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedMap:
    """The period map of a spring with several stops.

    Its points are phi_k q_k and phi_k q_k'/omega_k [m], with the drive's omega for slower modes.
    """

    oscillator: ImpactOscillator

    @property
    def scale(self) -> float:
        """The narrowest gap [m]."""
        return min(stop.gap for stop in self.oscillator.stops)

    def at(self, excess: float) -> SimulatedMap:
        """The same spring at another excess [1]."""
        return SimulatedMap(oscillator=self.oscillator.with_excess(excess))

    def steady(self) -> State:
        """The steady motion at a strobe, as it would be without stops."""
        drive = self.oscillator.driven
        steady = drive.amplitude * self.oscillator.steady_response()
        return State(displacement=steady.imag, velocity=drive.angular_frequency * steady.real)

    def orbit(self, state: State, count: int) -> StrobedOrbit[State]:
        """`count` drive periods from `state`."""
        run, model = simulate(self.oscillator, state, periods=count), self.oscillator.model
        slowness = model.phi / np.maximum(model.omega, self.oscillator.driven.angular_frequency)
        points = np.hstack([model.phi * run.strobe_displacement, slowness * run.strobe_velocity])
        return StrobedOrbit(end=run.end, points=points, impacts=run.strobe_impacts)
