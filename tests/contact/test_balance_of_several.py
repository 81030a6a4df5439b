"""Energy of motions with several contacts at the same time: work of drive and load, damping, and losses."""

import numpy as np
import pytest
from oscillators import before_stops, newton

from contact import HarmonicDrive, ImpactKind, ImpactOscillator, LinearContact, simulate

NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def mixture(rng: np.random.Generator) -> ImpactOscillator:
    """One to eight modes with two to four stops of both laws, some pressed by a load."""
    n, m = int(rng.integers(1, 9)), int(rng.integers(2, 5))
    omega = np.append(1.0, np.sort(rng.uniform(1.3, 40.0, n - 1)))
    rows = rng.uniform(-1.0, 1.0, (m, n)) * omega**-0.5
    rows[:, 0] = rng.choice([-1, 1], m) * rng.uniform(0.5, 1.5, m)
    stops = []
    for row in rows:
        e, k = float(rng.choice([0.0, rng.uniform(0.0, 0.7)])), float(rng.uniform(3, 30) ** 2 / (row @ row))
        law = newton(e) if rng.random() < 0.6 else LinearContact(stiffness=k)
        stops.append((float(rng.uniform(0.05, 0.5)), law))
    decay = 2.0 * 10.0 ** rng.uniform(-3.0, -1.3, n) * omega
    gamma = rng.uniform(-1.0, 1.0, n) * omega**-0.5 + np.eye(1, n)[0]
    drive = HarmonicDrive(frequency=rng.uniform(0.4, 1.6) / (2 * np.pi), amplitude=rng.uniform(0.2, 1.0))
    load = float(rng.integers(2)) * rng.uniform(-1.0, 1.0, n) * omega
    return before_stops(omega, decay, gamma, rows, stops, drive=drive, load=load)


@pytest.mark.filterwarnings("ignore::beam.SuspiciousValue")
def test_energy_balance_is_closed_over_any_mixture():
    """Work of the drive and the load, less damping and all losses, is the energy of the modes at the end.

    The powers are integrated between the events, by Gauss's rule on pieces of 0.8 radians at most.
    """
    rng, overlaps, stays, together = np.random.default_rng(61), 0, 0, 0
    for _ in range(40):
        oscillator, end = mixture(rng), 60.0
        i = simulate(oscillator, duration=end).impacts
        cuts = [np.arange(0.0, end, 0.8 / oscillator.model.omega.max()), [end], i.start, i.end]
        cuts = np.unique(np.concatenate(cuts))
        cuts = cuts[(cuts >= 0.0) & (cuts <= end)]
        half, middle = np.diff(cuts) / 2, (cuts[1:] + cuts[:-1]) / 2
        run = simulate(oscillator, duration=end, times=(middle[:, None] + half[:, None] * NODES).ravel())
        w, model = oscillator.drive.angular_frequency, oscillator.model
        pushed = model.participation * oscillator.drive.amplitude * w**2
        force = np.multiply.outer(np.sin(w * run.time), pushed)
        power = (force + oscillator.load - model.decay_rate * run.velocity) * run.velocity
        work, flow = (half @ (each.sum(1).reshape(-1, 20) @ WEIGHTS) for each in (power, np.abs(power)))
        energy = float(oscillator.energy(run.end.displacement, run.end.velocity))
        assert energy + i.loss.sum() - work == pytest.approx(0.0, abs=1e-12 * (flow + energy))
        stays += int(np.sum(i.kind == ImpactKind.STAY))
        together += int(i.together.sum())
        last = np.where(np.isnan(i.end), end, i.end)
        overlaps += int(np.sum((i.start[1:] < last[:-1]) & (i.stop[1:] != i.stop[:-1])))
    assert min(overlaps, stays) > 50 and together > 10
