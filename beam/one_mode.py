"""The oscillator with one degree of freedom: Eq. (1) of the letter, xi'' + mu xi' + omega^2 xi = -z''."""

import numpy as np

from .modal_model import ModalModel
from .parameters import require_within


def single_mode(*, free_period: float, decay_rate: float) -> ModalModel:
    """Return a model with one mode of unit mass, phi = participation = 1: the letter's equation (1).

    Parameters
    ----------
    free_period : float
        Period T of the free *damped* oscillation [s], positive; omega^2 = (2 pi / T)^2 + (decay_rate / 2)^2.
    decay_rate : float
        The letter's mu [1/s], not negative: amplitudes fall as exp(-mu t / 2).

    Returns
    -------
    ModalModel
        The model with this mode, n_modes = 1.

    Raises
    ------
    ValueError
        If `free_period` is not positive, or `decay_rate` is negative.
    TypeError
        If a value is not a number.

    See Also
    --------
    ModalModel : A model with any number of modes.
    free_period_change : The derivative with respect to the free period.
    contact.ImpactOscillator : The model with a drive and a stop.

    Examples
    --------
    >>> from beam import single_mode
    >>> spring = single_mode(free_period=40.80e-3, decay_rate=3.56)
    >>> round(float(spring.omega[0]), 2), round(float(spring.frequencies_hz[0]), 2)  # [rad/s], [Hz]
    (154.01, 24.51)
    """
    require_within("free_period", free_period, "s", above=0)
    require_within("decay_rate", decay_rate, "1/s", low=0)
    omega = np.hypot(2.0 * np.pi / free_period, 0.5 * decay_rate)
    one = np.ones(1)
    return ModalModel(omega=omega * one, decay_rate=decay_rate * one, phi=one, participation=one)
