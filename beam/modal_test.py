"""Modes from poles and residues of a modal test; `ModalModel.from_residues` has the equations."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .parameters import Array, InvalidType, require, require_kind, shown, suspect
from .point import row_of

Complex = NDArray[np.complex128]

RESPONSES = ("displacement", "velocity", "acceleration")
FORCE_UNITS, BASE_UNITS = ("m/(N s)", "m/(N s^2)", "m/(N s^3)"), ("s", "1", "1/s")
"""Responses of the tip, each the derivative of the one before, and the units of their residues."""
LARGEST_ANGLE, SUSPICIOUS_ANGLE = 45.0, 10.0
"""Angles off the phase for a real mode [degrees]: the largest, where half of |R|^2 contradicts a real mode,
and the largest without a warning, where 3 % do. Noise of a careful test leaves less."""


def modes_of_residues(
    poles: ArrayLike, force_residues: ArrayLike, base_residues: ArrayLike, response: str
) -> dict[str, Array]:
    """Return omega, decay_rate, phi and participation, see `ModalModel.from_residues`."""
    words = f"one of {', '.join(RESPONSES)}"
    require_kind("response", response, str, words)
    require(response in RESPONSES, "response", f"is {shown(response)}; it must be {words}")
    order, pole = RESPONSES.index(response), complex_row("poles", poles, "rad/s")
    for k in np.flatnonzero((pole.real > 0.0) | (pole.imag <= 0.0)):
        valid = "-c/2 + i omega_d, with c not negative and omega_d above zero (give no conjugates)"
        require(False, "poles", f"holds {pole[k]:.6g} rad/s in mode {k + 1}; it must be {valid}")
    force = complex_row("force_residues", force_residues, FORCE_UNITS[order], like=pole)
    base = complex_row("base_residues", base_residues, BASE_UNITS[order], like=pole)
    factor = 2j * pole.imag / pole**order
    square, product = force * factor, -base * factor
    for k in np.flatnonzero(square == 0.0):
        require(False, "force_residues", f"is 0 in mode {k + 1}; leave out a mode that does not move the tip")
    require_near_real("force_residues", square, response)
    require_near_real("base_residues", product * np.where(product.real < 0.0, -1.0, 1.0), response)
    phi = np.sqrt(square.real)
    return dict(omega=abs(pole), decay_rate=-2.0 * pole.real, phi=phi, participation=product.real / phi)


def require_near_real(name: str, values: Complex, response: str) -> None:
    """Refuse the residues, or warn of them, unless these numbers are positive but for noise."""
    angles = np.degrees(np.angle(values))
    k = int(np.argmax(abs(angles)))
    words = f"has a phase in mode {k + 1} that is {angles[k]:.0f} degrees off the phase for a real mode"
    valid = f"it must be within {LARGEST_ANGLE:g} degrees, and response is {shown(response)}"
    require(bool(abs(angles[k]) <= LARGEST_ANGLE), name, f"{words}; {valid}")
    if abs(angles[k]) > SUSPICIOUS_ANGLE:
        suspect(f"{name} {words}; above {SUSPICIOUS_ANGLE:g} a model with real modes is doubtful")


def complex_row(name: str, values: ArrayLike, unit: str, like: Complex | None = None) -> Complex:
    """Return a complex copy of shape (n,), n >= 1, all finite, with the shape of `like`."""
    try:
        given = np.asarray(values)
    except ValueError:  # rows of different lengths
        given = np.asarray(None)
    if given.dtype.kind not in "iufc":
        raise InvalidType(name, f"is {shown(values)}; it must be one row of complex numbers in {unit}")
    shape = given.shape if like is None else like.shape
    require(given.shape == shape, name, f"has shape {given.shape}; it must have the shape {shape} of poles")
    return row_of(name, given.real, unit) + 1j * row_of(name, given.imag, unit)
