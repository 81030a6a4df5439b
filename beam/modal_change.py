"""How the numbers that an impact sees of a spring change with a parameter of it.

A `ModalModel` holds omega_k, c_k, phi_k and Gamma_k of each mode. Here are their derivatives with respect to
one parameter p, and where they come from.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .parameters import require_array, require_whole


@dataclass(frozen=True, kw_only=True, eq=False)
class ModalChange:
    """Derivatives of the four arrays of a `ModalModel` with respect to one parameter.

    Units are those of the array per unit of the parameter. Any sequence of numbers may be given; it is stored
    as a read-only float64 copy.

    Parameters
    ----------
    omega : array_like, shape (n_modes,)
        Of the undamped angular frequencies [rad/s per unit].
    decay_rate : array_like, shape (n_modes,)
        Of the coefficients of q' [1/s per unit].
    phi : array_like, shape (n_modes,)
        Of the tip values [kg^(-1/2) per unit].
    participation : array_like, shape (n_modes,)
        Of the participations in a motion of the base [kg^(1/2) per unit].
    """

    omega: NDArray[np.float64]
    decay_rate: NDArray[np.float64]
    phi: NDArray[np.float64]
    participation: NDArray[np.float64]

    def __post_init__(self) -> None:
        shape = np.shape(self.omega)
        for field in fields(self):
            words = "one row of numbers, one for each mode,"
            row = require_array(
                field.name, getattr(self, field.name), "its unit per unit of the parameter", dimensions=1,
                shape=shape, words=words,
            )  # fmt: skip
            object.__setattr__(self, field.name, row)

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return self.omega.size

    def truncated(self, count: int) -> ModalChange:
        """Return the change of the first `count` modes only, 1 <= count <= n_modes."""
        count = require_whole("count", count, "modes", high=self.n_modes, why=", those of the change")
        return ModalChange(**{field.name: getattr(self, field.name)[:count] for field in fields(self)})
