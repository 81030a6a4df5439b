"""Modal model of a spring: uncoupled oscillators that share one tip.

A linear structure on a moving base, with natural frequencies omega_k [rad/s] and mass-normalised mode shapes,
obeys for each mode

    q_k'' + c_k q_k' + omega_k^2 q_k = -Gamma_k z'' + phi_k F,          x = sum_k phi_k q_k,

with z the displacement of the base [m], F a force on the tip in the drive direction [N], x the displacement
of the tip relative to the base [m], and

    q_k      modal coordinate                                          [kg^(1/2) m]
    c_k      `decay_rate`: amplitudes fall as exp(-c_k t / 2)           [1/s]
    phi_k    tip value of shape k in the drive direction               [kg^(-1/2)]
    Gamma_k  `participation` of shape k in a motion of the base         [kg^(1/2)]

An impact depends on these four arrays only, each of shape (n_modes,). Damping is modal: it does not couple
the modes. With C the `static_compliance` [m/N] and M the lumped mass at the tip [kg], all modes together have

    sum phi_k^2/omega_k^2 = C,   sum phi_k^2 = 1/M,   sum Gamma_k phi_k = 1        (``docs/theory/beam.md``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .exciter import modes_on_exciter
from .modal_test import modes_of_residues
from .parameters import final, record, require, require_kind, require_whole, require_within, shown, suspect
from .point import Point, check_statics, require_own_statics, row_of
from .residual_mode import residual_mode

UNITS = {"omega": "rad/s", "decay_rate": "1/s", "phi": "kg^(-1/2)", "participation": "kg^(1/2)"}
"""Units of the arrays of a modal model."""
GREATEST_RATIO = 0.5
"""Largest damping ratio of the lowest mode without a warning; damping alloys reach 0.1."""
STILL = 1e-9
"""Frequency that replaces zero where modes are compared [rad/s]; rounding of phi over it is still small."""


@final
@record
class ModalModel:
    """A structure as n_modes uncoupled oscillators that share one tip.

    Parameters
    ----------
    omega : array_like, shape (n_modes,)
        Undamped angular frequencies [rad/s], not negative; 0 is a rigid-body mode. This array and the next
        three are stored as read-only float64 copies.
    decay_rate : array_like, shape (n_modes,)
        Coefficient of q' in each modal equation [1/s], not negative; may exceed 2 omega (overdamped).
    phi : array_like, shape (n_modes,)
        Mass-normalised tip values in the drive direction [kg^(-1/2)]. At the tip mode k is a mass 1/phi_k^2.
    participation : array_like, shape (n_modes,)
        Participation in a base motion along the drive direction [kg^(1/2)]: the force on mode k per unit
        deceleration of the base. A modal test gives it and `phi`: `from_residues`, ``docs/guide/own.md``.
    static_compliance, tip_mass : float, optional
        Compliance [m/N] and mass [kg] of the tip, see `Point`. With another `phi` give both anew.
    points : mapping of str to Point, optional
        Further places by name. "tip", made of `phi` and the two numbers above, is always among them.
    dimensionless : bool
        Whether lengths, masses and times are in units of your own, so that no size in metres is suspicious.

    Raises
    ------
    ValueError
        If a value is negative or not finite, or an array has another shape than `omega`. Also if the two
        numbers of the tip belong to another `phi`.
    TypeError
        If an array does not hold real numbers, or another value is of the wrong kind.

    Warns
    -----
    SuspiciousValue
        If the lowest mode that vibrates has a damping ratio above 0.5.

    See Also
    --------
    reduce : The modal model of a discretized leaf spring.
    single_mode : The model with one mode, Eq. (1) of the letter.
    contact.ImpactOscillator : The model with a drive and a stop.

    Examples
    --------
    >>> from beam import ModalModel
    >>> measured = ModalModel(omega=[154, 960], decay_rate=[3.6, 20], phi=[8, 9], participation=[0.1, 0.05])
    >>> [round(f, 1) for f in measured.frequencies_hz.tolist()]
    [24.5, 152.8]
    >>> round(1e3 * measured.free_period, 2)  # [ms]
    40.8
    """

    omega: NDArray[np.float64]
    decay_rate: NDArray[np.float64]
    phi: NDArray[np.float64]
    participation: NDArray[np.float64]
    static_compliance: float | None = None
    tip_mass: float | None = None
    points: Mapping[str, Point] = field(default_factory=dict)
    dimensionless: bool = False

    def __post_init__(self) -> None:
        rows = {name: row_of(name, getattr(self, name), unit) for name, unit in UNITS.items()}
        omega = rows["omega"]
        for name in ("omega", "decay_rate"):
            least = rows[name].min()
            require(least >= 0.0, name, f"holds {least} {UNITS[name]}; no entry may be negative")
        vars(self).update(rows)
        require_kind("dimensionless", self.dimensionless, bool, "True or False")
        points = dict(require_kind("points", self.points, Mapping, "a mapping of names to Point"))
        for name, point in points.items():
            require_kind(f"points[{name!r}]", point, Point, "a Point")
        old = points.pop("tip", None)
        rows |= {f"points[{name!r}]": point.row for name, point in points.items()}
        for name, row in rows.items():
            words = f"it must have the shape {omega.shape} of omega"
            require(row.shape == omega.shape, name, f"has shape {row.shape}; {words}")
        check_statics(self, static_compliance="m/N", tip_mass="kg")
        tip = Point(row=self.phi, static_compliance=self.static_compliance, mass=self.tip_mass)
        vars(self).update(points=points | {"tip": tip})
        require_own_statics(tip, old)
        lowest = int(np.argmin(np.where(omega > 0.0, omega, np.inf)))
        ratio = 0.5 * self.decay_rate[lowest] / omega[lowest] if omega[lowest] > 0.0 else 0.0
        if ratio > GREATEST_RATIO:
            words = f"a damping ratio of {ratio:.3g}; above {GREATEST_RATIO:g} it hardly oscillates"
            suspect(f"decay_rate is {self.decay_rate[lowest]:g} 1/s in the lowest mode, {words}")

    @classmethod
    def from_matrices(
        cls, M: object, K: object, *, points: Mapping[str, object], base: object, modes: int, C: object = None
    ) -> ModalModel:
        """Return the lowest modes of a structure M x'' + C x' + K x = -M base z'' + sum of row times force.

        Parameters
        ----------
        M, K : array_like or sparse array, shape (n, n)
            Mass [kg, for displacements] and stiffness [N/m], symmetric. K may be singular, and M too.
        points : mapping of str to array_like or sparse array, shape (n,)
            Rows: the motion of a point is ``row @ x`` [m]. "tip" is the tip, or else the first of them.
        base : array_like or sparse array, shape (n,)
            Unit rigid motion of the base along the drive, at each unknown [1].
        modes : int
            Number of modes, at most the number of unknowns with mass.
        C : array_like or sparse array, shape (n, n), optional
            Damping [kg/s] that does not couple the modes; none by default.

        Returns
        -------
        ModalModel
            The lowest modes, with the statics of the whole structure.

        Raises
        ------
        ValueError
            If a matrix is not symmetric, not finite or of another size, or M or K is negative. Also if no
            mode moves a point, C couples modes, or rounding leaves no digits.
        """
        from .matrices import modes_of_matrices  # finite elements are slow to import

        rows, found = modes_of_matrices(M, K, points, base, modes, C)
        c, m = found["tip"].static_compliance, found["tip"].mass
        return cls(**rows, static_compliance=c, tip_mass=m, points=found, dimensionless=False)

    @classmethod
    def from_residues(
        cls,
        *,
        poles: ArrayLike,
        force_residues: ArrayLike,
        base_residues: ArrayLike,
        response: str = "displacement",
        static_compliance: float | None = None,
        tip_mass: float | None = None,
    ) -> ModalModel:
        """Return the modes of a modal test, from poles and residues of two frequency responses of the tip.

        Parameters
        ----------
        poles : array_like, shape (n_modes,)
            Poles lambda_k = -c_k/2 + i omega_dk = omega_k (-zeta_k + i sqrt(1 - zeta_k^2)) [rad/s].
        force_residues, base_residues : array_like, shape (n_modes,)
            Complex residues of two tests: with a force on the tip [m/(N s), for a displacement], and with an
            acceleration of the base [s]. The motion of the tip may be absolute or relative to the base.
        response : {"displacement", "velocity", "acceleration"}
            What both tests measured.
        static_compliance, tip_mass : float, optional
            Compliance [m/N] and mass [kg] of the tip, see `Point`.

        Returns
        -------
        ModalModel
            The modes, with `phi` positive.

        Raises
        ------
        ValueError
            If a pole is not in the upper left half plane, or a residue is far from that of a real mode.

        Warns
        -----
        SuspiciousValue
            If the phase of a residue is more than 10 degrees off the phase for a real mode.

        Notes
        -----
        A response is the sum of R_k/(i w - lambda_k) and conjugates. R_k = phi_k^2/(2 i omega_dk) over a
        force, and -Gamma_k phi_k/(2 i omega_dk) over an acceleration; of a velocity, they are lambda_k R_k.

        Examples
        --------
        >>> from beam import ModalModel
        >>> test = dict(poles=[-1.8 + 154j], force_residues=[-0.208j], base_residues=[0.0026j])
        >>> ModalModel.from_residues(**test).phi.round(2).tolist()  # [kg^(-1/2)]
        [8.0]
        """
        rows = modes_of_residues(poles, force_residues, base_residues, response)
        c, m = static_compliance, tip_mass
        return cls(**rows, static_compliance=c, tip_mass=m, points={}, dimensionless=False)

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return self.omega.size

    @property
    def frequencies_hz(self) -> NDArray[np.float64]:
        """Undamped natural frequencies [Hz], shape (n_modes,)."""
        return self.omega / (2.0 * np.pi)

    @property
    def leading_mode(self) -> int:
        """Index of "mode 1": the mode with the largest part phi^2/omega^2 of the static compliance.

        On an exciter the lowest mode may be another one, the mode of the suspension.
        """
        return int(np.argmax(np.abs(self.phi) / np.maximum(self.omega, STILL)))

    @property
    def free_period(self) -> float:
        """Period of the free damped oscillation of mode 1 [s]; ValueError if it is overdamped."""
        omega, rate = self.omega[self.leading_mode], self.decay_rate[self.leading_mode]
        square = omega**2 - (0.5 * rate) ** 2
        given = f"omega is {omega} rad/s and decay_rate {rate} 1/s in mode 1"
        require(square > 0.0, f"{given}; it does not oscillate, so there is no free period")
        return float(2.0 * np.pi / np.sqrt(square))

    def truncated(self, count: int) -> ModalModel:
        """Return the same structure with its first `count` modes only, 1 <= count <= n_modes."""
        count = require_whole("count", count, "modes", high=self.n_modes, why=", the modes of the model")
        points = {name: replace(point, row=point.row[:count]) for name, point in self.points.items()}
        return replace(self, **{name: getattr(self, name)[:count] for name in UNITS}, points=points)

    def load_of(self, forces: Mapping[str, float]) -> NDArray[np.float64]:
        """Return the modal load [N kg^(-1/2)], shape (n_modes,), of constant `forces` [N] on named points.

        Each force acts along the motion of its point, as ``ImpactOscillator(load=...)`` takes it.
        """
        load = np.zeros(self.n_modes)
        for name, force in require_kind("forces", forces, Mapping, "a mapping of points to forces").items():
            words = f"names {shown(name)}; points are {', '.join(self.points)}"
            require(name in self.points, "forces", words)
            load += require_within(f"forces[{name!r}]", force, "N") * self.points[name].row
        return load

    def with_residual_mode(self) -> ModalModel:
        """Return the model with one more mode, which replaces all modes left out.

        The static compliance and the tip mass, which an instant impact meets, are then exact. The mode takes
        the damping ratio of the highest mode and moves no point but the tip. ValueError if one of these two
        numbers is not known, or the modes already supply almost all of it.
        """
        rows = {name: getattr(self, name) for name in UNITS}
        mode = residual_mode(rows, self.static_compliance, self.tip_mass)
        rows = {name: np.append(row, mode[name]) for name, row in rows.items()}
        own = {name: mode["phi"] * (name == "tip") for name in self.points}
        points = {name: replace(p, row=np.append(p.row, own[name])) for name, p in self.points.items()}
        return replace(self, **rows, points=points)

    def on_exciter(
        self, *, mass: float, suspension_hz: float, damping_ratio: float = 0.0, measured_on_it: bool = False
    ) -> ModalModel:
        """Return the coupled modes of this spring and of an exciter, whose table its forces move by z.

        `mass` [kg] is the whole moving mass, spring included, and exceeds sum Gamma_k^2. `suspension_hz` [Hz]
        and `damping_ratio` [1] belong to the suspension of the table. The modes of this model must belong to
        a fixed base. If mode 1 was `measured_on_it`, the mode that moves the tip most keeps the frequency and
        the decay rate of mode 1.

        The stop rides on the base, so that the contact force acts on q alone. `participation` then refers to
        a force on the base that would move a free body of this mass as the drive moves the base. Damping
        stays modal. Static compliance, tip mass and further points are dropped.
        """
        rows, base = {name: getattr(self, name) for name in UNITS}, (mass, suspension_hz, damping_ratio)
        rows |= modes_on_exciter(rows, self.leading_mode, *base, measured_on_it)
        return ModalModel(**rows, dimensionless=self.dimensionless)
