"""``simulate``: a motion as a trajectory of named arrays, by a method that fits the contact law.

Without a chosen method the exact one is taken (``contact.integrators``).  Its error is that of rounding;
``studies.methods.work_precision`` compares its cost with that of the other methods and of outside solvers.
"""

from inspect import signature

import numpy as np

from beam.parameters import InvalidType, require, require_kind, suspect
from contact.engine.plan import plan_of
from contact.flight.modal_flow import steady_motion
from contact.flight.numbers import LOAD
from contact.integrators import INTEGRATORS, Exact, Integrator
from contact.integrators.method import LAW_NAMES
from contact.oscillator import ImpactOscillator
from contact.state import State
from contact.trajectory import Trajectory


def _method(method: Integrator | str | None, oscillator: ImpactOscillator) -> Integrator:
    """The chosen method, or the exact one; refused if it does not know the law or follows one stop only."""
    chosen: object = Exact() if method is None else method
    if isinstance(chosen, str):
        require(chosen in INTEGRATORS, f"method is {method!r}; it must be one of {', '.join(INTEGRATORS)}")
        kind = INTEGRATORS[chosen]
        try:
            chosen = kind()
        except TypeError:
            needed = next(iter(signature(kind).parameters))
            words = f"method is {method!r}, which needs {needed}; give {kind.__name__}({needed}=...)"
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
    """Return the motion of an impact oscillator with all its impacts.

    The motion is exact to rounding unless another method is chosen.

    Parameters
    ----------
    oscillator : ImpactOscillator
        Spring with its stops and its drive.
    state : State, optional
        State at the start; by default the spring is at rest at time zero.
    duration : float, optional
        Length of the run [s].  Give either `duration` or `periods`.
    periods : int, optional
        Length of the run in drive periods; in periods of the lowest mode if the base is at rest.
    times : array_like, shape (n_times,), optional
        Rising times within the run at which the state is wanted [s].
    method : Integrator or str, optional
        Method in place of the exact one, such as ``contact.integrators.CentralDifference(step=1e-6)``, or the
        name of a method without a step in ``contact.integrators.INTEGRATORS``.

    Returns
    -------
    Trajectory
        Strobed states, states at `times`, all impacts, and the state at the end.

    Raises
    ------
    ValueError
        If not exactly one of `duration` and `periods` is given, or it is not above zero.  If times do not
        rise or lie outside the run.  If the state has another number of modes, or lies behind the stop of an
        impact law.  If the name of the method is unknown, or the method follows a single stop only.
    TypeError
        If the method does not follow the contact law or needs a step, or an argument is of another kind.
    StepTooLarge
        If the step of the method is beyond its limit of stability.
    Diverged
        If the motion of a method with a step has grown without bound.
    UnresolvedCrossing
        If a part of the motion could be proved neither free nor touching.
    Chatter
        If there are more impacts in one drive period than the bound allows.
    ContactTooStiff
        If a contact needs more steps than the bound allows.
    TouchedAtOnce
        If two stops are touched at once, and the law of one is followed alone.

    Warns
    -----
    SuspiciousValue
        If nothing moves: a spring at rest and a drive of amplitude zero.

    See Also
    --------
    ImpactOscillator.with_excess : The same oscillator, driven relative to grazing.
    collisions : The effect of each collision of a trajectory on mode 1.
    contact.orbits.settle : The periodic orbit that a motion approaches.

    Notes
    -----
    A tip may lie on the stop at the start, within rounding.  It touches the stop at once if it moves towards
    it, and leaves if it moves or is pulled away.  At rest and pressed, or without any force, it stays:

    - under Newton's law as a STAY of approach 0,
    - under a force law as a contact UNDER_WAY that begins at depth 0,
    - under `DelayedRestitution` as a contact UNDER_WAY, for the delay of the lowest speed.  This law has no
      longer rest, so that a tip that is still pressed raises an UnresolvedCrossing.

    Examples
    --------
    The letter's spring just above grazing settles on an orbit with one impact in five drive periods:

    >>> from beam import single_mode
    >>> from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate
    >>> oscillator = ImpactOscillator(
    ...     model=single_mode(free_period=40.80e-3, decay_rate=3.56),
    ...     stop=Stop(gap=11.9e-3, law=NewtonRestitution(local_restitution=0.1)),
    ...     drive=HarmonicDrive(frequency=22.2),
    ... )
    >>> trajectory = simulate(oscillator.with_excess(1e-3), periods=1000)
    >>> print(trajectory.strobe_impacts[-50:].sum(), trajectory.impacts.approach[-3:].round(3))
    10 [0.369 0.369 0.369]
    """
    require_kind("oscillator", oscillator, ImpactOscillator, "an ImpactOscillator")
    chosen = _method(method, oscillator)
    start = State.rest(oscillator.n_modes) if state is None else require_state(oscillator, state)
    plan = plan_of(oscillator, start, duration, periods, times)
    _suspect_rest(oscillator, start)
    return chosen.follow(oscillator, plan)
