"""The impact oscillator: modes of a spring, the motion of its base, and one stop or several.

    q_k'' + c_k q_k' + omega_k^2 q_k = -Gamma_k z''(t) + g_k - sum_j phi_jk N_j(d_j, d_j')
    x_j = sum_k phi_jk q_k,   d_j = x_j - gap_j,   z = Z sin(2 pi f t)

with mass-normalised modes (q in m kg^0.5), x_j the displacement towards stop j relative to the base [m], N_j
>= 0 the contact force [N] and g_k an optional constant modal load [N kg^-0.5].  A single stop is most often
at the tip, and x is then its displacement.  With one mode, phi = Gamma = 1 and
``NewtonRestitution`` this is Eq. (1) of the letter (1996), whose F is Z (2 pi f)^2.

Steady response without contact: q_k = Z Im(H_k exp(i 2 pi f t)), H_k = Gamma_k w^2 / (omega_k^2 - w^2 + i c_k
w), about the static displacement g_k/omega_k^2.  The tip just touches the stop at the grazing amplitude Z_g =
(gap - sum_k phi_k g_k/omega_k^2) / |sum_k phi_k H_k|.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from beam import ModalModel
from beam.parameters import InvalidValue, final, require, require_array, require_kind, require_within, shown
from contact.drive import HarmonicDrive
from contact.flight.numbers import Numbers, numbers_of, stacked, with_drive
from contact.laws import NewtonRestitution
from contact.plausible import suspect_sizes
from contact.stop import Stop, given_stops, rows_of


def dynamic_stiffness(omega: np.ndarray, decay_rate: np.ndarray, w: float) -> np.ndarray:
    """E_k = omega_k^2 - w^2 + i c_k w of modes driven at frequency `w` [rad/s], complex [1/s^2]."""
    # (omega - w)(omega + w) keeps its digits close to resonance, where omega^2 - w^2 would lose them
    return np.asarray((omega - w) * (omega + w) + 1j * decay_rate * w)


@final
@dataclass(frozen=True, kw_only=True, eq=False, init=False)
class ImpactOscillator:
    """A modal spring on a moving base, with one stop or several.

    Parameters
    ----------
    model : ModalModel
        Modes: omega, decay_rate, phi, participation, each (n_modes,), and points by name.
    stop : Stop
        The only stop; or give `stops`.
    stops : sequence of Stop
        Stops at points of the model, on either side.  Touches name them by their numbers from 0 on.
    drive : HarmonicDrive or None
        Base motion; None for a base at rest.
    load : ndarray, shape (n_modes,), optional
        Constant modal load [N kg^-0.5].
    simultaneous : {"moreau", "sequential"}
        The law if several stops of Newton's law are met at one instant, or one while a point rests on
        another: Moreau's for all of them, or one stop after the other, that with the largest approach
        velocity first (``contact.touch.impulses``).  ``docs/several_stops.md`` says which suits what.

    Simulation takes any number of stops.  What holds for a single stop at the tip, such as collisions, maps
    and periodic orbits, refuses others in one sentence.

    Sizes that no spring and no exciter has bring a SuspiciousValue warning (``contact.plausible``).
    """

    model: ModalModel
    stops: tuple[Stop, ...]
    drive: HarmonicDrive | None = None
    load: np.ndarray | None = None
    simultaneous: str = "moreau"
    _rows: ClassVar[list[np.ndarray]]  # weights of the modes in the height over each stop, (n_modes,) each

    if TYPE_CHECKING:
        stop: Stop  # for ``dataclasses.replace``
    else:

        @property
        def stop(self) -> Stop:
            """The only stop; ValueError for several."""
            return self.stops[0] if len(self.stops) == 1 else self.only_stop("this")

    def __init__(
        self,
        *,
        model: ModalModel,
        stop: Stop | None = None,
        stops: Sequence[Stop] | None = None,
        drive: HarmonicDrive | None = None,
        load: np.ndarray | None = None,
        simultaneous: str = "moreau",
    ) -> None:
        given = given_stops(stop, stops)
        vars(self).update(model=model, stops=given, drive=drive, load=load, simultaneous=simultaneous)
        self._check()

    def _check(self) -> None:
        """Refuse what cannot be followed, and warn of what can hardly be meant."""
        require_kind("model", self.model, ModalModel, "a ModalModel")
        require_kind("drive", self.drive, (HarmonicDrive, type(None)), "a HarmonicDrive or None")
        words = f"is {shown(self.simultaneous)}; it must be 'moreau' or 'sequential'"
        require(self.simultaneous in ("moreau", "sequential"), "simultaneous", words)
        omega, decay = self.model.omega, self.model.decay_rate
        vars(self).update(_rows=rows_of(self.stops, self.model))
        if self.load is not None:
            words = f"{omega.size} finite modal loads"
            load = require_array("load", self.load, "N kg^-0.5", shape=omega.shape, words=words)
            object.__setattr__(self, "load", load)
        gap = min(stop.gap for stop in self.stops)
        suspect_sizes(self.model, max(stop.gap for stop in self.stops), self.drive)
        if self.drive is None:
            return
        require(gap > 0, "gap", f"is {gap} m; for a driven spring it must be above zero")
        resonant = (omega == self.drive.angular_frequency) & (decay == 0)
        words = f"{self.drive.frequency:g} Hz, that of an undamped mode without steady motion; it must differ"
        require(not np.any(resonant), "frequency of the drive", f"is {words}")

    @property
    def n_modes(self) -> int:
        """Number of modes [1]."""
        return int(self.model.omega.size)

    @property
    def period(self) -> float:
        """Drive period [s]; of a base at rest, the period of the lowest mode that oscillates (1 s if none
        does)."""
        if self.drive is not None:
            return self.drive.period
        oscillating = self.model.omega[self.model.omega > 0]
        return float(2 * np.pi / oscillating.min()) if oscillating.size else 1.0

    @property
    def driven(self) -> HarmonicDrive:
        """The drive; ValueError for a base at rest."""
        if self.drive is None:
            raise InvalidValue("drive is None; this needs a spring on a moving base, so give a HarmonicDrive")
        return self.drive

    @property
    def unit_speed(self) -> float:
        """2 pi f gap: the speed to which approach speeds compare [m/s]."""
        return self.driven.angular_frequency * self.stop.gap

    @property
    def local_restitution(self) -> float:
        """The restitution of Newton's law at the stop [1], at the lowest speed if it depends on the speed.

        TypeError is raised for an oscillator with another law.
        """
        words = "a NewtonRestitution, or a restitution must be given"
        law: NewtonRestitution = require_kind("law of the stop", self.stop.law, NewtonRestitution, words)
        return law.numbers[0]

    def with_amplitude(self, amplitude: float) -> ImpactOscillator:
        """The same oscillator driven with another base amplitude [m].

        A search may pass through any amplitude: none is suspicious here.
        """
        number = require_within("amplitude", amplitude, "m", low=0)
        changed = copy.copy(self)  # all else has been checked
        object.__setattr__(changed, "drive", replace(self.driven, amplitude=number))
        changed.__dict__.pop("_motion", None)
        return changed

    def with_excess(self, excess: float) -> ImpactOscillator:
        """The same oscillator driven at F/F_g - 1 = `excess` [1]."""
        number = require_within("excess", excess, "[1]", above=-1)
        return self.with_amplitude((1.0 + number) * self.grazing_amplitude())

    def heights(self, displacement: np.ndarray) -> np.ndarray:
        """Heights d_j over all stops [m], shape (..., n_stops), of modal displacements (..., n_modes); below
        zero where a stop is not reached."""
        return np.asarray(displacement) @ np.transpose(self._rows) - [stop.gap for stop in self.stops]

    def tip(self, values: np.ndarray) -> np.ndarray:
        """Tip displacement relative to the base [m], or tip velocity [m/s], shape (...), of modal
        displacements or velocities `values`, shape (..., n_modes); NaN gives NaN."""
        try:
            return np.asarray(values) @ self.model.phi
        except (TypeError, ValueError):
            valid = f"an array of shape (..., {self.n_modes}), a number for each mode"
            raise InvalidValue(f"values is {shown(values)}; it must be {valid}") from None

    def steady_response(self) -> np.ndarray:
        """H_k, complex, shape (n_modes,) [kg^0.5]: without contact q_k(t) = g_k/omega_k^2 + Z Im(H_k exp(i 2
        pi f t))."""
        if self.drive is None:
            return np.zeros(self.n_modes, dtype=complex)
        w, model = self.drive.angular_frequency, self.model
        return model.participation * w**2 / dynamic_stiffness(model.omega, model.decay_rate, w)

    def tip_response(self) -> complex:
        """Tip displacement per base amplitude without contact, complex [1]."""
        seen = self._only_at_one_metre
        return complex(seen.tip_sine, seen.tip_cosine)

    @cached_property
    def mean_height(self) -> float:
        """Static tip displacement minus gap, about which the steady motion oscillates [m]; ValueError if
        there is no steady motion."""
        self._require_steady()
        return self._only_at_one_metre.level

    def _require_steady(self) -> None:
        """Refuse a base at rest, and a load under which a mode drifts."""
        _ = self.driven
        if self.load is not None:
            words = "for a steady motion it must be zero on a mode of zero frequency, which drifts"
            drifts = np.any(self.load[self.model.omega == 0.0])
            require(not drifts, f"load is {shown(self.load.tolist())} N kg^-0.5; {words}")

    def drive_at(self, reach: float, rate: float) -> tuple[float, float]:
        """Base amplitude [m] and drive time [s] at which the steady tip motion has displacement `reach` [m]
        and velocity `rate` [m/s]."""
        w, height = self.driven.angular_frequency, reach - (self.mean_height + self.stop.gap)
        # x = x_0 + Z Im(H e^{i w t}), x' = Z w Re(H e^{i w t}), so Z e^{i w t} = C + i S with
        phasor = np.complex128(complex(rate / w, height)) / self.tip_response()
        return abs(phasor), float(np.angle(phasor) % (2.0 * np.pi)) / w

    def grazing_amplitude(self) -> float:
        """Base amplitude Z_g at which the steady motion just touches a stop, the first of several [m]."""
        self._require_steady()
        reached = []
        for seen in self._at_one_metre:
            level, gap, response = seen.level, seen.gap, seen.amplitude
            words = f"the static displacement {level + gap:g} m must stay below it"
            require(level < 0.0, f"gap is {gap} m; {words}")
            reached += [-level / response] if response > 0.0 else []
        words = "the drive does not move the tip; at least one mode must have both other than zero"
        require(bool(reached), f"phi and participation are such that {words}")
        return float(min(reached))

    @property
    def excess(self) -> float:
        """F/F_g - 1 [1]."""
        return self.driven.amplitude / self.grazing_amplitude() - 1.0

    def energy(self, displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Kinetic and elastic energy of modal states, arrays (..., n_modes) -> (...) [J]; contact
        excluded."""
        q, v = np.asarray(displacement), np.asarray(velocity)
        return 0.5 * np.sum(v**2 + (self.model.omega * q) ** 2, axis=-1)

    def numbers(self) -> Numbers:
        """The numbers of an oscillator with one stop at the tip, as the kernels take them; not to be written
        into.  ValueError is raised for several stops, or one elsewhere."""
        self.only_stop("this")
        return self._motion

    def stacked(self) -> Numbers:
        """The numbers with all stops, as simulation takes them; not to be written into."""
        return self._motion

    def only_stop(self, what: str) -> Stop:
        """The only stop, at the tip and on its positive side; ValueError says that `what` needs this."""
        words = f"{what} needs one stop at the tip, on its positive side"
        require(len(self.stops) == 1, "stops", f"has {len(self.stops)} entries; {words}")
        at, side = self.stops[0].at, self.stops[0].side
        hint = "give a model whose phi is the row of that stop"
        require(at == "tip" and side == 1, "stop", f"is at {at!r}, side {side:+d}; {words}, so {hint}")
        return self.stops[0]

    @cached_property
    def _motion(self) -> Numbers:
        seen, drive = self._at_one_metre, self.drive
        views = seen if drive is None else [with_drive(one, drive.amplitude) for one in seen]
        return views[0] if len(views) == 1 else stacked(views, self.simultaneous == "sequential")

    @property
    def _only_at_one_metre(self) -> Numbers:
        self.only_stop("this")
        return self._at_one_metre[0]

    @cached_property
    def _at_one_metre(self) -> list[Numbers]:
        """The numbers that each stop sees at an amplitude of 1 m; oscillators that `with_amplitude` has made
        share them."""
        return [
            numbers_of(
                self.model.omega,
                self.model.decay_rate,
                row,
                law=stop.law,
                gap=stop.gap,
                drive=0.0 if self.drive is None else self.drive.angular_frequency,
                period=self.period,
                response=self.steady_response(),
                load=self.load,
            )
            for stop, row in zip(self.stops, self._rows, strict=True)
        ]


def require_one_stop(oscillator: object, what: str) -> ImpactOscillator:
    """The oscillator, refused unless it is one, with `ImpactOscillator.only_stop` for `what`."""
    given: ImpactOscillator = require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator")
    given.only_stop(what)
    return given
