"""The letter's spring under several laws, and what its simulated motion says of a periodic orbit."""

import math
from dataclasses import replace

import numpy as np
from letters_spring import FOLD_MODES, GAP, HERTZ, letters_spring

import contact
from beam import ModalModel
from contact.orbits import PeriodicOrbit, Settled, settle

LAWS = {
    "hertz": HERTZ,
    "hunt-crossley": contact.HuntCrossley(stiffness=HERTZ.stiffness, dissipation=0.3),
    "linear": contact.LinearContact(stiffness=1.887e7),
    "dashpot": contact.LinearContact(stiffness=1.887e7, damping=68.0),
    "newton": contact.NewtonRestitution(local_restitution=0.3),
}
DELAYED = {
    "constant": contact.DelayedRestitution(restitution=0.1, delay=1e-4),
    "plastic": contact.DelayedRestitution(restitution=0.0, delay=5e-4),
    "elastic": contact.DelayedRestitution(restitution=0.9, delay=2e-3),
    "table": contact.DelayedRestitution(restitution=lambda v: 0.3 / (1 + v), delay=lambda v: 4e-4 + 2e-4 * v),
    "falling": contact.DelayedRestitution(
        restitution=lambda v: 0.4 * math.exp(-v), delay=lambda v: 2e-4 * v**0.2
    ),
}
# f [Hz], m, F_m/F_g - 1, and F/F_g - 1 at which the orbit gains a second impact (its rounding: last digit)
EQUATION_1 = [
    (20.90, 3, -1.2784409283e-3, 0.0891, 1e-4),
    (21.50, 4, -1.32105924246e-2, 0.0101, 1e-4),
    (22.20, 5, -1.4773426733e-3, 0.0273, 1e-4),
    (22.60, 6, -1.6810390565e-4, 0.0250, 1e-4),
    (23.05, 8, -1.2823017008e-4, 0.0133, 1e-4),
    (23.40, 11, -1.0196700981e-3, 0.002274, 1e-6),
]


def beam(
    frequency: float, law: contact.ContactLaw, modes: int = FOLD_MODES, ratio: float | None = None
) -> contact.ImpactOscillator:
    """The letter's spring with `modes` modes; with `ratio`, that damping ratio in all modes but the first."""
    model = letters_spring(modes)
    if ratio is not None:
        decay = np.append(model.decay_rate[0], 2.0 * ratio * model.omega[1:])
        model = replace(model, decay_rate=decay)
    return on_stop(model, frequency, law)


def on_stop(
    model: ModalModel, frequency: float, law: contact.ContactLaw = HERTZ, gap: float = GAP
) -> contact.ImpactOscillator:
    """A spring before its stop, driven at `frequency` [Hz]."""
    stop, drive = contact.Stop(gap=gap, law=law), contact.HarmonicDrive(frequency=frequency)
    return contact.ImpactOscillator(model=model, stop=stop, drive=drive)


def settled(
    oscillator: contact.ImpactOscillator, excess: float, cycles: int = 4000
) -> Settled[contact.State]:
    """Where the motion from below grazing comes to rest."""
    strobed = contact.StroboscopicMap(oscillator=oscillator)
    return settle(strobed.at(excess), strobed.at(-1e-3).steady(), most_cycles=cycles)


def sizes(oscillator: contact.ImpactOscillator) -> np.ndarray:
    """Scales of (q, q') of all modes."""
    model, size = oscillator.model, oscillator.stop.gap / np.abs(oscillator.model.phi).max()
    return np.concatenate([np.full(model.omega.size, size), size * model.omega])


def differences(orbit: PeriodicOrbit) -> tuple[np.ndarray, float]:
    """Multipliers by central differences of the simulated map over m periods, and how well the orbit
    closes."""
    oscillator, n = orbit.oscillator, orbit.oscillator.n_modes
    strobed, scale = contact.StroboscopicMap(oscillator=oscillator), sizes(oscillator)

    def after(point: np.ndarray) -> np.ndarray:
        end = strobed.orbit(contact.State(displacement=point[:n], velocity=point[n:]), orbit.m).end
        return np.concatenate([end.displacement, end.velocity])

    state = orbit.strobe_state()
    assert state.regime == 0
    point = np.concatenate([state.displacement, state.velocity])
    step = 1e-7 * np.diag(scale)
    columns = [(after(point + h) - after(point - h)) / 2e-7 / scale for h in step]
    return np.linalg.eigvals(np.column_stack(columns)), float(np.max(np.abs(after(point) - point) / scale))


def touches(orbit: PeriodicOrbit) -> int:
    """Touches of the simulated motion from just before the first one to just before it comes again."""
    duration = orbit.m * orbit.oscillator.period * (1 - 1e-6)
    run = contact.simulate(orbit.oscillator, orbit.state(), duration=duration)
    return int(np.count_nonzero(run.impacts.kind == 0))
