"""A spring on an exciter: coupled modes of the spring and of the moving table that drives it.

The table moves by z [m] on a suspension of frequency f_s [Hz], with the whole moving mass m [kg], spring
included. With frequencies omega and participations Gamma of the spring on a fixed base,

    M = [[1, Gamma], [Gamma^T, m]],     K = diag(omega^2, (2 pi f_s)^2 m).

If mode 1 was measured on the exciter, omega_1 of the fixed base is computed such that the coupled mode has
the measured frequency (``docs/theory/beam.md``).
"""

from collections.abc import Mapping

import numpy as np

from .parameters import Array, require_within


def modes_on_exciter(
    rows: Mapping[str, Array],
    leading: int,
    mass: float,
    suspension_hz: float,
    damping_ratio: float,
    measured_on_it: bool,
) -> dict[str, Array]:
    """Return the four arrays of a `ModalModel` by name, from the arrays `rows` of the spring on a fixed base.

    `leading` is the index of mode 1. The other arguments are explained at `ModalModel.on_exciter`.
    """
    from scipy.linalg import eigh  # slow to import

    require_within("suspension_hz", suspension_hz, "Hz", low=0)
    require_within("damping_ratio", damping_ratio, "[1]", low=0)
    gamma, square, n, k = rows["participation"], rows["omega"] ** 2, rows["omega"].size, leading
    require_within("mass", mass, "kg", above=float(gamma @ gamma))
    own = (2.0 * np.pi * suspension_hz) ** 2
    if measured_on_it:
        kept, others = square[k], np.sum(np.delete(gamma, k) ** 2 / (np.delete(square, k) - square[k]))
        square[k] += (kept * gamma[k]) ** 2 / ((own - kept) * mass - kept**2 * others)
    inertia = np.diag(np.append(np.ones(n), mass))
    inertia[n, :n] = inertia[:n, n] = gamma
    found, shapes = eigh(np.diag(np.append(square, mass * own)), inertia)
    phi = rows["phi"] @ shapes[:n]
    rates = np.append(rows["decay_rate"], 2.0 * damping_ratio * np.sqrt(own) * mass) @ shapes**2
    if measured_on_it:
        rates[np.argmax(np.abs(phi))] = rows["decay_rate"][k]
    omega = np.sqrt(np.maximum(found, 0.0))
    return dict(omega=omega, decay_rate=rates, phi=phi, participation=mass * shapes[n])
