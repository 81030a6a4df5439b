"""The impact oscillator: modes of a spring, the motion of its base, and one stop or several.

    q_k'' + c_k q_k' + omega_k^2 q_k = -Gamma_k z''(t) + g_k - sum_j phi_jk N_j(d_j, d_j')
    x_j = sum_k phi_jk q_k,   d_j = x_j - gap_j,   z = Z sin(2 pi f t)

with mass-normalised modes (q in m kg^0.5), x_j the displacement towards stop j relative to the base [m], N_j
>= 0 the contact force [N] and g_k an optional constant modal load [N kg^(-1/2)].  A single stop is most often
at the tip, and x is then its displacement.  With one mode, phi = Gamma = 1 and
``NewtonRestitution`` this is Eq. (1) of the letter (1996), whose F is Z (2 pi f)^2.  The motion without
contact, and the amplitude Z_g at which it grazes the stop, are in ``contact.steady_response``.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from beam import ModalModel
from beam.parameters import InvalidValue, final, require, require_array, require_kind, require_within, shown
from beam.record import record
from contact.drive import HarmonicDrive
from contact.flight.numbers import Numbers, numbers_of, stacked, with_drive
from contact.laws import NewtonRestitution
from contact.plausible import suspect_sizes
from contact.steady_response import lowest_grazing, refuse_drift, refuse_resonance, response_of
from contact.stop import Stop, given_stops, only_stop_of, rows_of


@final
@record(init=False)
class ImpactOscillator:
    """A modal spring on a moving base, with one stop or several.

    Simulation takes any number of stops.  Collisions, maps and periodic orbits need a single stop at the tip.

    Parameters
    ----------
    model : ModalModel
        Modes of the spring, and its points by name.
    stop : Stop, optional
        The only stop.  Give either `stop` or `stops`.
    stops : sequence of Stop, optional
        Stops at points of the model, on either side.  `Impacts` names them by their numbers from 0 on.
    drive : HarmonicDrive, optional
        Base motion; None for a base at rest.
    load : array_like, shape (n_modes,), optional
        Constant modal load [N kg^(-1/2)].
    simultaneous : {"moreau", "sequential"}
        Rule if several stops of Newton's law are hit at one instant, or one while a point rests on another:
        Moreau's law for all of them, or one after the other, the fastest approach first
        (``contact.touch.impulses``).  ``docs/guide/several_stops.md`` compares the two.

    Raises
    ------
    ValueError
        If not exactly one of `stop` and `stops` is given, a stop cannot be reached, or two stops lie at one
        place.  If a driven spring has a gap of zero, or the frequency of the drive is that of an undamped
        mode.  If the load does not fit the model, or `simultaneous` is another word.
    TypeError
        If an argument is of another kind, or the law of a stop holds for one mode and the model has more.

    Warns
    -----
    SuspiciousValue
        If a gap, the amplitude or the frequency of the drive has a size that no spring and no exciter has.

    See Also
    --------
    simulate : The motion of an oscillator, with its impacts.
    StroboscopicMap : The map of its state from one drive period to the next.
    MaximalFamily : Its periodic orbits with one impact, in closed form.

    Examples
    --------
    The letter's spring, driven at 0.1 % above the amplitude at which it grazes the stop:

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop
    >>> oscillator = ImpactOscillator(
    ...     model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    ...     stop=Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1)),
    ...     drive=HarmonicDrive(frequency=22.2),
    ... )
    >>> print(f"{1e3 * oscillator.grazing_amplitude():.3f} mm")
    2.625 mm
    >>> print(f"{1e3 * oscillator.with_excess(1e-3).drive.amplitude:.3f} mm")
    2.627 mm
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
        omega = self.model.omega
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
        refuse_resonance(self.model, self.drive)

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
        """Return the same oscillator driven with another base `amplitude` [m], zero or more."""
        # a search may pass through any amplitude: none is suspicious here
        number = require_within("amplitude", amplitude, "m", low=0)
        changed = copy.copy(self)  # all else has been checked
        object.__setattr__(changed, "drive", replace(self.driven, amplitude=number))
        changed.__dict__.pop("_motion", None)
        return changed

    def with_excess(self, excess: float) -> ImpactOscillator:
        """Return the same oscillator driven at F/F_g - 1 = `excess` [1], above -1."""
        number = require_within("excess", excess, "[1]", above=-1)
        return self.with_amplitude((1.0 + number) * self.grazing_amplitude())

    def heights(self, displacement: np.ndarray) -> np.ndarray:
        """Return the heights d_j over all stops, shape (..., n_stops) [m]; below zero off the stop."""
        return np.asarray(displacement) @ np.transpose(self._rows) - [stop.gap for stop in self.stops]

    def tip(self, values: np.ndarray) -> np.ndarray:
        """Return the tip displacement relative to the base [m] or its velocity [m/s], shape (...), of modal
        displacements or velocities `values`, shape (..., n_modes); NaN gives NaN."""
        try:
            return np.asarray(values) @ self.model.phi
        except (TypeError, ValueError):
            valid = f"an array of shape (..., {self.n_modes}), a number for each mode"
            raise InvalidValue(f"values is {shown(values)}; it must be {valid}") from None

    def steady_response(self) -> np.ndarray:
        """Return H_k, complex, shape (n_modes,) [kg^(1/2)], of ``contact.steady_response``."""
        return response_of(self.model, self.drive)

    def tip_response(self) -> complex:
        """Return the tip displacement per base amplitude without contact, complex [1]."""
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
        refuse_drift(self.model, self.load)

    def drive_at(self, reach: float, rate: float) -> tuple[float, float]:
        """Return the base amplitude [m] and the drive time [s] that give the steady tip motion the
        displacement `reach` [m] and the velocity `rate` [m/s]."""
        w, height = self.driven.angular_frequency, reach - (self.mean_height + self.stop.gap)
        # x = x_0 + Z Im(H e^{i w t}), x' = Z w Re(H e^{i w t}), so Z e^{i w t} = C + i S with
        phasor = np.complex128(complex(rate / w, height)) / self.tip_response()
        return abs(phasor), float(np.angle(phasor) % (2.0 * np.pi)) / w

    def grazing_amplitude(self) -> float:
        """Return the lowest base amplitude at which the steady motion just touches a stop [m]."""
        self._require_steady()
        return lowest_grazing(self._at_one_metre)

    @property
    def excess(self) -> float:
        """Drive amplitude relative to grazing, F/F_g - 1 [1]."""
        return self.driven.amplitude / self.grazing_amplitude() - 1.0

    def energy(self, displacement: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return the kinetic and elastic energy of modal states (..., n_modes) without contact [J]."""
        q, v = np.asarray(displacement), np.asarray(velocity)
        return 0.5 * np.sum(v**2 + (self.model.omega * q) ** 2, axis=-1)

    def numbers(self) -> Numbers:
        """Return the read-only numbers for kernels of one stop at the tip; ValueError for other stops."""
        self.only_stop("this")
        return self._motion

    def stacked(self) -> Numbers:
        """Return the read-only numbers for kernels with all stops, as simulation takes them."""
        return self._motion

    def only_stop(self, what: str) -> Stop:
        """Return the only stop, at the tip on its positive side; ValueError says that `what` needs this."""
        return only_stop_of(self.stops, what)

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
