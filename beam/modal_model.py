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

An impact depends on these four arrays only, each of shape (n_modes,). They may come from `natural_modes`, a
formula, or a file of measured modes.

Damping is modal: it does not couple the modes, which holds for light damping and separated frequencies (T. K.
Caughey and M. E. J. O'Kelly, J. Appl. Mech. 32 (1965) 583).

One mode is Eq. (1) of the letter: with unit mass, phi = Gamma = 1 and the damped period
T = 2 pi / sqrt(omega^2 - (mu/2)^2) the equation above is  xi'' + mu xi' + omega^2 xi = -z''.

The modes are complete. A static tip force, an impulse on the tip and a translation of the base therefore give

    sum phi_k^2/omega_k^2 = C,   sum phi_k^2 = 1/M,   sum Gamma_k phi_k = 1

over all modes, C the `static_compliance` [m/N] and M the lumped mass at the tip [kg]. A truncation to n modes
makes the tip too stiff by the residual compliance C - sum_{k <= n} phi_k^2/omega_k^2, and too heavy likewise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from .parameters import final, require, require_kind, require_whole, require_within, shown, suspect
from .point import Point, check_statics, row_of

UNITS = {"omega": "rad/s", "decay_rate": "1/s", "phi": "kg^(-1/2)", "participation": "kg^(1/2)"}
"""Units of the arrays of a modal model."""
LEAST_RESIDUAL = 1e-5
"""Smallest ratio of residual to static compliance of a residual mode. Finite elements give statics to 1e-7,
so that the residual is then uncertain by 1 %."""
GREATEST_RATIO = 0.5
"""Largest damping ratio of the lowest mode without a warning; damping alloys reach 0.1."""
STILL = 1e-9
"""Frequency that replaces zero where modes are compared [rad/s]; rounding of phi over it is still small."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class ModalModel:
    """A structure as n_modes uncoupled oscillators that share one tip.

    Any sequence of numbers may be given; it is stored as a read-only float64 copy.

    Parameters
    ----------
    omega : array_like, shape (n_modes,)
        Undamped angular frequencies [rad/s], not negative; 0 is a rigid-body mode.
    decay_rate : array_like, shape (n_modes,)
        Coefficient of q' in each modal equation [1/s], not negative; may exceed 2 omega (overdamped).
    phi : array_like, shape (n_modes,)
        Mass-normalised tip values in the drive direction [kg^(-1/2)].
    participation : array_like, shape (n_modes,)
        Participation in a base motion along the drive direction [kg^(1/2)].
    static_compliance, tip_mass : float, optional
        Compliance [m/N] and mass [kg] of the tip, see `Point`. With another `phi` give both anew.
    points : mapping of str to Point, optional
        Further places by name. "tip", made of `phi` and the two numbers above, is always among them.
    dimensionless : bool
        Whether lengths, masses and times are in units of your own, so that no size in metres is suspicious.

    Warns
    -----
    SuspiciousValue
        For a lowest mode that vibrates with a damping ratio above `GREATEST_RATIO`.
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
        if old is not None and any(abs(a) != abs(b) for a, b in zip(old.row, tip.row, strict=False)):
            words = "which belongs to another phi; it must be given for this phi, or None"
            c, m = tip.static_compliance, tip.mass
            require(c is None or c != old.static_compliance, "static_compliance", f"is {c} m/N, {words}")
            require(m is None or m != old.mass, "tip_mass", f"is {m} kg, {words}")
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

        Raises
        ------
        ValueError
            For matrices that are not symmetric, not finite or of other sizes, an M or K that is negative, a
            point that no mode moves, a C that couples modes, or digits lost to rounding.
        """
        from .matrices import modes_of_matrices  # finite elements are slow to import

        rows, found = modes_of_matrices(M, K, points, base, modes, C)
        c, m = found["tip"].static_compliance, found["tip"].mass
        return cls(**rows, static_compliance=c, tip_mass=m, points=found, dimensionless=False)

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
        """Index of "mode 1" of a single-mode description: the mode with the largest part phi^2/omega^2 of the
        static compliance. On an exciter the lowest mode may belong to the suspension."""
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
        """Return the modal load of constant `forces` [N] on named points, shape (n_modes,) [N kg^(-1/2)].

        Each acts along the motion of its point, as ``ImpactOscillator(load=...)`` takes it.
        """
        load = np.zeros(self.n_modes)
        for name, force in require_kind("forces", forces, Mapping, "a mapping of points to forces").items():
            require(
                name in self.points, "forces", f"names {shown(name)}; points are {', '.join(self.points)}"
            )
            load += require_within(f"forces[{name!r}]", force, "N") * self.points[name].row
        return load

    def with_residual_mode(self) -> ModalModel:
        """Return the model with one more mode, which replaces all modes left out.

        The mode supplies the terms missing in the sums over all modes (see the module),

            phi^2 = 1/M - sum phi_k^2,   phi^2/omega^2 = C - sum phi_k^2/omega_k^2,
            Gamma phi = 1 - sum Gamma_k phi_k.

        The static compliance C and the tip mass M, which an instant impact meets, are then exact. The mode
        takes the damping ratio of the highest mode and moves no point but the tip.

        Raises
        ------
        ValueError
            If the model has no static compliance or tip mass, or its modes leave nothing of one of them.
        """
        for name, unit in (("static_compliance", "m/N"), ("tip_mass", "kg")):
            value = getattr(self, name)
            require(bool(value), name, f"is {value} {unit}; the residual mode needs it, above zero")
        assert self.static_compliance is not None and self.tip_mass is not None
        oscillating = self.omega > 0.0
        squares = np.where(oscillating, self.omega, 1.0) ** 2
        square = 1.0 / self.tip_mass - float(self.phi @ self.phi)
        compliance = self.static_compliance - float(np.where(oscillating, self.phi**2 / squares, 0.0).sum())
        given = f"tip_mass is {self.tip_mass} kg and static_compliance {self.static_compliance} m/N"
        left = f"the modes lack {square:.3g} 1/kg of 1/tip_mass and {compliance:.3g} m/N of the compliance"
        words = f"{given}; {left}, which must be above zero and above {LEAST_RESIDUAL:g} of the whole"
        require(square > 0.0 and compliance > LEAST_RESIDUAL * self.static_compliance, words)
        phi, omega = np.sqrt(square), np.sqrt(square / compliance)
        ratio = self.decay_rate[-1] / self.omega[-1] if self.omega[-1] > 0.0 else 0.0
        participation = (1.0 - float(self.phi @ self.participation)) / phi
        return replace(
            self,
            omega=np.append(self.omega, omega),
            decay_rate=np.append(self.decay_rate, ratio * omega),
            phi=np.append(self.phi, phi),
            participation=np.append(self.participation, participation),
            points={n: replace(p, row=np.append(p.row, phi * (n == "tip"))) for n, p in self.points.items()},
        )

    def on_exciter(
        self, *, mass: float, suspension_hz: float, damping_ratio: float = 0.0, measured_on_it: bool = False
    ) -> ModalModel:
        """Return the coupled modes of this spring and of an exciter, whose table its forces move by z.

        `mass` m [kg] is the whole moving mass, spring included. `suspension_hz` f_s [Hz] and `damping_ratio`
        [1] belong to the suspension of the table:

            M = [[1, Gamma], [Gamma^T, m]],     K = diag(omega^2, (2 pi f_s)^2 m).

        The stop rides on the base, so that the contact force acts on q alone. `participation` then refers to
        a force on the base that would move a free mass m as the drive moves the base. Damping stays modal;
        static compliance, tip mass and further points are dropped.

        This model's modes must belong to a fixed base. If mode 1 was `measured_on_it`, the mode that moves
        the tip most keeps the frequency and the decay rate of mode 1.
        """
        from scipy.linalg import eigh  # slow to import

        require_within("suspension_hz", suspension_hz, "Hz", low=0)
        require_within("damping_ratio", damping_ratio, "[1]", low=0)
        gamma, square, n, k = self.participation, self.omega**2, self.n_modes, self.leading_mode
        require_within("mass", mass, "kg", above=float(gamma @ gamma))
        own = (2.0 * np.pi * suspension_hz) ** 2
        if measured_on_it:
            kept, others = square[k], np.sum(np.delete(gamma, k) ** 2 / (np.delete(square, k) - square[k]))
            square[k] += (kept * gamma[k]) ** 2 / ((own - kept) * mass - kept**2 * others)
        inertia = np.diag(np.append(np.ones(n), mass))
        inertia[n, :n] = inertia[:n, n] = gamma
        found, shapes = eigh(np.diag(np.append(square, mass * own)), inertia)
        phi = self.phi @ shapes[:n]
        rates = np.append(self.decay_rate, 2.0 * damping_ratio * np.sqrt(own) * mass) @ shapes**2
        if measured_on_it:
            rates[np.argmax(np.abs(phi))] = self.decay_rate[k]
        omega = np.sqrt(np.maximum(found, 0.0))
        return ModalModel(
            omega=omega,
            decay_rate=rates,
            phi=phi,
            participation=mass * shapes[n],
            dimensionless=self.dimensionless,
        )


def single_mode(*, free_period: float, decay_rate: float) -> ModalModel:
    """Return Eq. (1) of the letter: one mode of unit mass, phi = participation = 1.

    Parameters
    ----------
    free_period : float
        Period T of the free *damped* oscillation [s], positive; omega^2 = (2 pi / T)^2 + (decay_rate / 2)^2.
    decay_rate : float
        The letter's mu [1/s], not negative: amplitudes fall as exp(-mu t / 2).
    """
    require_within("free_period", free_period, "s", above=0)
    require_within("decay_rate", decay_rate, "1/s", low=0)
    omega = np.hypot(2.0 * np.pi / free_period, 0.5 * decay_rate)
    one = np.ones(1)
    return ModalModel(omega=omega * one, decay_rate=decay_rate * one, phi=one, participation=one)
