"""``simulate``: a motion as a trajectory of named arrays, by a method that fits the contact law.

Without a chosen method the exact one is taken: event-driven for an impact law, piecewise-linear for a linear
contact, the contact series for Hertz's and Hunt and Crossley's laws.  Its error is that of rounding;
``studies.methods.work_precision`` compares its cost with that of the other methods and of outside solvers.
"""

import numpy as np

from beam.parameters import (
    InvalidType,
    InvalidValue,
    require,
    require_array,
    require_kind,
    require_whole,
    require_within,
    shown,
    suspect,
)
from contact.drive import split_time
from contact.flight.modal_flow import steady_motion
from contact.flight.motion import LOAD
from contact.integrators import INTEGRATORS, Exact, Integrator, Run
from contact.integrators.method import LAW_NAMES
from contact.oscillator import ImpactOscillator
from contact.trajectory import State, Trajectory

MOST_STORED = 2.0**28  # largest number of values in the strobes of one run: 2 GB


def _method(method: Integrator | str | None, oscillator: ImpactOscillator) -> Integrator:
    """The chosen method, or the exact one; refused if it does not know the law or follows one stop only."""
    chosen: object = Exact() if method is None else method
    if isinstance(chosen, str):
        require(chosen in INTEGRATORS, f"method is {method!r}; it must be one of {', '.join(INTEGRATORS)}")
        kind = INTEGRATORS[chosen]
        try:
            chosen = kind()
        except TypeError:
            words = f"method is {method!r}, which needs a step; give {kind.__name__}(step=...)"
            raise InvalidType(words) from None
    given: Integrator = require_kind("method", chosen, Integrator, "an Integrator or the name of one")
    for law in (stop.law.code for stop in oscillator.stops):
        if not given.accepts(law):
            known = ", ".join(LAW_NAMES[code] for code in given.laws)
            words = f"which follows {known}; the law of the stop is {LAW_NAMES[law]}"
            raise InvalidType(f"method is {given.name}, {words}")
    if not isinstance(given, Exact):
        oscillator.only_stop(f"the method {given.name}")
    return given


def require_state(oscillator: ImpactOscillator, state: object) -> State:
    """`state`, refused unless it is a State with as many modes as the oscillator."""
    given: State = require_kind("state", state, State, "a State")
    modes, known = given.displacement.size, oscillator.n_modes
    require(modes == known, f"displacement of the state has {modes} modes; the model has {known}")
    if isinstance(given.regime, tuple):
        regimes, stops = len(given.regime), len(oscillator.stops)
        words = f"regime of the state has {regimes} entries; it must have one for each stop, {stops}"
        require(regimes == stops, words)
    return given


def _suspect_rest(oscillator: ImpactOscillator, start: State) -> None:
    """Warn of a driven spring that never moves."""
    motion, still = oscillator.numbers(), not np.any(start.velocity)
    still = still and not motion.row(LOAD).any()  # a load moves a mode of zero frequency
    idle = oscillator.drive is not None and oscillator.drive.amplitude == 0.0
    if idle and still and np.all(start.displacement == steady_motion(motion, 0.0)[0]):
        words = "`with_excess` gives the same oscillator with one"
        suspect(f"amplitude of the drive is 0 m and the spring starts at rest: nothing moves; {words}")


def _run(
    oscillator: ImpactOscillator,
    start: State,
    duration: float | None,
    periods: int | None,
    times: np.ndarray | None,
) -> Run:
    """The run from `start` over one of `duration` and `periods`, checked."""
    words = "duration and periods are both given or both missing; give exactly one of them"
    require((duration is None) != (periods is None), words)
    period = oscillator.period
    whole = 0 if periods is None else require_whole("periods", periods, "drive periods")
    length = whole * period if whole else require_within("duration", duration, "s", above=0)
    if length / period * 2 * oscillator.n_modes > MOST_STORED:
        raise InvalidValue(
            f"duration is {length:g} s, {length / period:g} drive periods with {oscillator.n_modes} modes; "
            f"the strobes kept must stay below {MOST_STORED:g} numbers, so run it in pieces"
        )
    first, clock = (x.item() for x in split_time(start.time, period))
    last, clock_end = first + whole, clock
    if not whole:
        last, clock_end = (x.item() for x in split_time(start.time + length, period))
    words = "a rising array"
    wanted = require_array("times", () if times is None else times, "s", dimensions=1, words=words)
    if np.any(np.diff(wanted) < 0.0):  # the sentence is slow to make
        raise InvalidValue(f"times is {shown(wanted.tolist())} s; it must be {words}")
    begin, end, beside = start.time, start.time + length, 1e-12 * length
    if wanted.size and (wanted[0] < begin - beside or wanted[-1] > end + beside):
        words = f"they must lie within {begin} to {end} s"
        raise InvalidValue(f"times run from {wanted[0]} to {wanted[-1]} s; {words}")
    sample_period, sample_clock = split_time(wanted, period)
    late = (sample_period > last) | ((sample_period == last) & (sample_clock > clock_end))
    sample_period[late], sample_clock[late] = last, clock_end
    early = (sample_period < first) | ((sample_period == first) & (sample_clock < clock))
    sample_period[early], sample_clock[early] = first, clock
    return Run(
        start=start,
        length=length,
        first=first,
        last=last,
        clock=clock,
        clock_end=clock_end,
        times=wanted,
        sample_period=sample_period,
        sample_clock=sample_clock,
    )


def simulate(
    oscillator: ImpactOscillator,
    state: State | None = None,
    *,
    duration: float | None = None,
    periods: int | None = None,
    times: np.ndarray | None = None,
    method: Integrator | str | None = None,
) -> Trajectory:
    """Motion of an impact oscillator, with its impacts; exact unless another method is chosen.

    Parameters
    ----------
    oscillator : ImpactOscillator
    state : State, optional
        Where to start; the spring at rest at time zero if left out.
    duration, periods : float or int, optional
        Length of the run [s], or in drive periods; give one of them.
    times : array_like, optional
        Rising times within the run at which the state is wanted [s].
    method : Integrator or str, optional
        Another method than the exact one, e.g. ``CentralDifference(step=1e-6)``;
        ``contact.integrators.INTEGRATORS`` lists them by name.

    Returns
    -------
    Trajectory
        Strobed states, states at `times`, impacts and the final state.

    A tip that lies on the stop at the start, within rounding, touches it at once if it moves towards it, and
    leaves if it moves or is pulled away.  At rest and pressed, or without any force, it stays: under Newton's
    law as a STAY of approach 0, under a force law as a contact UNDER_WAY that begins at depth 0, and under
    DelayedRestitution for the delay of its lowest speed, UNDER_WAY too.  That law has no longer rest: a
    ContactError says so.

    ValueError is raised for a run of no length, times out of order or range, or a start behind the wall of an
    impact law; TypeError for a method that does not know the law; StepTooLarge for a step beyond its
    limit of stability; and UnresolvedCrossing, Chatter or ContactTooStiff where the motion could not be
    followed.  A driven spring at rest whose drive has no amplitude brings a SuspiciousValue warning.
    """
    require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator")
    chosen = _method(method, oscillator)
    start = State.rest(oscillator.n_modes) if state is None else require_state(oscillator, state)
    run = _run(oscillator, start, duration, periods, times)
    _suspect_rest(oscillator, start)
    return chosen.follow(oscillator, run)
