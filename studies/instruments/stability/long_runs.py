r"""Long runs: phase and energy of the default after up to a million drive periods.

The exact methods multiply a flight by the exact flow of a drive period: what remains is its rounding, the
same in every period, at most of the size of eps for each. Measured against 60 digits.

An orbit that repeats every m periods should repeat to rounding: measured on the p_m node of Eq. (1) with
Newton's law, whose closed form is known (``contact.orbits.single_impact``).

The drift of the methods with a step is in ``phase_drift``, the energy over many contacts in ``energy_walk``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from beam.reduction import ModalModel
from contact.drive import HarmonicDrive
from contact.laws import NewtonRestitution
from contact.orbits.single_impact import MaximalFamily, SingleImpactOrbit
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap
from contact.trajectory import State
from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.stability.energy_walk import bounces
from studies.instruments.stability.extended_precision import flow_of_doubles
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.long_figures import draw_long
from studies.instruments.stability.phase_drift import OMEGA, drifts

__all__ = ["draw", "measure", "stable_node"]

EPS = 2.0**-52
EXCESS = 1e-3
"""F/F_g - 1 of the periodic orbit."""
SETTLING = 2000
"""Repetitions of the orbit before it is compared with itself: by then the start has been forgotten."""


def _flight(periods: int) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The default in free flight against 60 digits."""
    law = NewtonRestitution(local_restitution=0.5)
    drive = HarmonicDrive(frequency=22.2)
    one = np.ones(1)
    oscillator = ImpactOscillator(
        model=ModalModel(omega=OMEGA * one, decay_rate=0.0 * one, phi=one, participation=one),
        stop=Stop(gap=10.0, law=law), drive=drive,
    )  # fmt: skip
    run = simulate(oscillator, State(displacement=one, velocity=0.0 * one), periods=periods)
    count = np.unique(np.geomspace(1, periods, 13).astype(int))
    phase, energy = [], []
    for n in count:
        a, _b, c, _d = flow_of_doubles(OMEGA, 0.0, float(n) * drive.period)
        exact = complex(a, -c / OMEGA)
        q, v = run.strobe_displacement[n - 1, 0], run.strobe_velocity[n - 1, 0]
        change = np.log(complex(q, -v / OMEGA) / exact)
        phase.append(abs(change.imag))
        energy.append(abs(2.0 * change.real))
    limits = [
        Limit(
            method="event-driven", case=f"undamped free flight, {periods:.0e} drive periods", knob=knob,
            theory=None, measured=values[-1], refused=None,
            note=f"eps for each period, the size that the rounding of its flow lets expect, is "
            f"{EPS * periods:.1e}",
        )
        for knob, values in (("phase error [rad]", phase), ("relative change of energy [1]", energy))
    ]  # fmt: skip
    return limits, {
        "flight_periods": count, "flight_phase": np.array(phase), "flight_energy": np.array(energy),
    }  # fmt: skip


def stable_node(oscillator: ImpactOscillator, excess: float) -> SingleImpactOrbit:
    """The stable orbit with one impact in the fewest drive periods, from two on."""
    for m in range(2, 16):
        for orbit in MaximalFamily.from_oscillator(oscillator, period=m).orbits(excess):
            if orbit.stable and orbit.admissible:
                return orbit
    raise ValueError(f"there is no stable orbit with one impact at excess {excess:g}")


def _orbit(scene: Scene, periods: int) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The p_m node of Eq. (1), followed for `periods` periods."""
    frequency = sorted(scene.drive.frequencies_hz)[len(scene.drive.frequencies_hz) // 2 - 1]
    single = single_mode_oscillator(scene, frequency)
    orbit = stable_node(single, EXCESS)
    m = orbit.family.period
    strobed = StroboscopicMap(oscillator=single.with_amplitude(orbit.amplitude))
    settled = strobed.orbit(strobed.steady(), SETTLING * m).end
    again = State(displacement=settled.displacement, velocity=settled.velocity)
    points = strobed.orbit(again, periods - periods % m).points
    last = points[-m:]
    apart = np.abs(points.reshape(-1, m, 2) - last).max(axis=(1, 2)) / strobed.scale
    kinds = len({row.tobytes() for row in points})
    # the closed form at the strobes after the impact
    begun = orbit.flight.start * frequency
    times = (math.ceil(begun) + np.arange(m)) / frequency
    q, v = orbit.state(times)
    closed = np.column_stack([q[0], v[0] / single.model.omega[0]])
    off = min(float(np.abs(last - np.roll(closed, k, axis=0)).max()) for k in range(m)) / strobed.scale
    limits = [
        Limit(
            method="event-driven", case=f"p{m} node of Eq. (1), {periods:.0e} drive periods", knob=knob,
            theory=0.0, measured=measured, refused=None, note=note,
        )
        for knob, measured, note in (
            ("departure from its own last period, in gaps [1]", float(apart.max()),
             f"{kinds} different strobe points in all; {m} are bit-periodic"),
            ("departure from the closed form, in gaps [1]", off, "at the end of the run"),
        )
    ]  # fmt: skip
    return limits, {"orbit_apart": apart[:: max(1, apart.size // 1000)]}


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Drifts of all methods, and the default over up to a million periods."""
    periods = 20_000 if quick else 1_000_000
    drifting, table = drifts(quick)
    flight, curve = _flight(periods)
    orbit, points = _orbit(scene, periods)
    return Findings(limits=[*flight, *orbit, *bounces(quick), *drifting], arrays={**table, **curve, **points})


def draw(findings: Findings, record: Any) -> None:
    """Phase error and growth over the step, and the error of the default over the periods."""
    record.write_figure(draw_long(findings.arrays), "long_runs")
