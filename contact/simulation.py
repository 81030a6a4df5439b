"""``simulate``: a motion as a trajectory of named arrays, by a method that fits the contact law.

Without a chosen method the exact one is taken (``contact.integrators``).  Its error is that of rounding;
``studies.methods.work_precision`` compares its cost with that of the other methods and of outside solvers.
"""

import numpy as np

from beam.parameters import InvalidType, require, require_kind, suspect
from contact.engine.plan import plan_of
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import LOAD
from contact.integrators import INTEGRATORS, Exact, Integrator
from contact.integrators.method import LAW_NAMES
from contact.oscillator import ImpactOscillator
from contact.trajectory import State, Trajectory


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
    numbers, still = oscillator.stacked(), not np.any(start.velocity)
    still = still and not numbers.row(LOAD).any()  # a load moves a mode of zero frequency
    idle = oscillator.drive is not None and oscillator.drive.amplitude == 0.0
    if idle and still and np.all(start.displacement == steady_motion(numbers, 0.0)[0]):
        words = "`with_excess` gives the same oscillator with one"
        suspect(f"amplitude of the drive is 0 m and the spring starts at rest: nothing moves; {words}")


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
    plan = plan_of(oscillator, start, duration, periods, times)
    _suspect_rest(oscillator, start)
    return chosen.follow(oscillator, plan)
