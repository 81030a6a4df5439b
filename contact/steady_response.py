"""The steady response of the modes without contact, and the drive amplitude at which it grazes a stop.

    q_k = Z Im(H_k exp(i w t)) + g_k/omega_k^2,   H_k = Gamma_k w^2 / (omega_k^2 - w^2 + i c_k w)

with w = 2 pi f and the letters of ``contact.oscillator``.  The tip just touches the stop at the grazing
amplitude

    Z_g = (gap - sum_k phi_k g_k/omega_k^2) / |sum_k phi_k H_k|.
"""

from collections.abc import Sequence

import numpy as np

from beam import ModalModel
from beam.parameters import require, shown
from contact.drive import HarmonicDrive
from contact.flight.numbers import Numbers


def dynamic_stiffness(omega: np.ndarray, decay_rate: np.ndarray, w: float) -> np.ndarray:
    """E_k = omega_k^2 - w^2 + i c_k w of modes driven at frequency `w` [rad/s], complex [1/s^2]."""
    # (omega - w)(omega + w) keeps its digits close to resonance, where omega^2 - w^2 would lose them
    return np.asarray((omega - w) * (omega + w) + 1j * decay_rate * w)


def refuse_resonance(model: ModalModel, drive: HarmonicDrive) -> None:
    """Refuse a drive at the frequency of an undamped mode, which has no steady motion."""
    resonant = (model.omega == drive.angular_frequency) & (model.decay_rate == 0)
    words = f"{drive.frequency:g} Hz, that of an undamped mode without steady motion; it must differ"
    require(not np.any(resonant), "frequency of the drive", f"is {words}")


def refuse_drift(model: ModalModel, load: np.ndarray | None) -> None:
    """Refuse a load under which a mode drifts."""
    if load is not None:
        words = "for a steady motion it must be zero on a mode of zero frequency, which drifts"
        drifts = np.any(load[model.omega == 0.0])
        require(not drifts, f"load is {shown(load.tolist())} N kg^-0.5; {words}")


def response_of(model: ModalModel, drive: HarmonicDrive | None) -> np.ndarray:
    """H_k, complex, shape (n_modes,) [kg^(1/2)]; zero for a base at rest."""
    if drive is None:
        return np.zeros(model.omega.size, dtype=complex)
    w = drive.angular_frequency
    return model.participation * w**2 / dynamic_stiffness(model.omega, model.decay_rate, w)


def lowest_grazing(views: Sequence[Numbers]) -> float:
    """The grazing amplitude Z_g of the stop that is reached first [m].

    `views` are the numbers that each stop sees at an amplitude of 1 m.
    """
    reached = []
    for seen in views:
        level, gap, response = seen.level, seen.gap, seen.amplitude
        words = f"the static displacement {level + gap:g} m must stay below it"
        require(level < 0.0, f"gap is {gap} m; {words}")
        reached += [-level / response] if response > 0.0 else []
    words = "the drive does not move the tip; at least one mode must have both other than zero"
    require(bool(reached), f"phi and participation are such that {words}")
    return float(min(reached))
