"""SciPy, heyoka and CVODE, each from one event to the next.

For SciPy and CVODE an event is a change of sign between two steps, so that pairs of crossings within a step
are missed; no longest step is set, as in most uses. heyoka looks for the roots of the Taylor polynomial of a
step. Under Hertz's law its series in time does not exist at the touch, where the force goes like t^(3/2), but
it does in sigma, dt = s dsigma with s = sqrt(d) (K. F. Sundman, Acta Math. 36 (1913) 105):

    dq/dsigma = s v,   dv/dsigma = s (f - phi k s^3),   ds/dsigma = d'/2,   dt/dsigma = s.

Touch and release are regular points; a wanted time within a contact is an event t = target. Compiling takes
0.05 to 0.4 s and is no part of the cost of a step: heyoka's integrators are kept for each number of modes,
kind of equation and tolerance, in each thread, with all physical numbers as plan-time parameters.
"""

import math
import threading
from typing import Any

import numpy as np

from studies.methods.peers.piecewise import Advance, Array, Equations, Piece

MOST_STEPS = 1_000_000
"""Bound of the steps of one piece, far beyond what a drive period takes at any tolerance."""

FAR = 1e30  # end of a piece in sigma, never reached: an event ends it [s m^-1/2]

Heyoka = Any  # an expression or integrator of heyoka, which has no types

_kept = threading.local()


def scipy_pieces(e: Equations, solver: str) -> Advance:
    """solve_ivp by `solver`."""
    from scipy.integrate import solve_ivp

    def advance(contact: bool, begin: float, y: Array, times: Array) -> Piece:
        def watched(t: float, state: Array) -> float:
            return e.surface(contact, begin, t, state)

        watched.terminal, watched.direction = True, 1  # type: ignore[attr-defined]
        more: dict[str, Any] = {}
        if solver == "LSODA" or (solver == "Radau" and contact and e.hertz):
            more["jac"] = lambda t, state: e.jacobian(contact, state)
        elif solver == "Radau":
            more["jac"] = e.jacobian(contact, y)  # constant
        with np.errstate(all="ignore"):  # trial steps too long may overflow, and are rejected
            found = solve_ivp(
                lambda t, state: e.rates(contact, t, state, np.empty(2 * e.n)),
                (begin, times[-1]),
                y,
                method=solver,
                t_eval=times,
                rtol=e.tolerance,
                atol=e.absolute,
                events=watched,
                **more,
            )
        samples = found.y.T if len(found.t) else np.empty((0, 2 * e.n))
        if not found.success:
            reached, last = (found.t[-1], samples[-1]) if len(found.t) else (begin, y)
            raise e.failed(float(reached), last, f"{solver} past this time: {found.message}")
        event = found.status != 0
        end = found.t_events[0][-1] if event else times[-1]
        state = np.array(found.y_events[0][-1] if event else samples[-1])
        return Piece(float(end), state, event, samples, int(found.nfev))

    return advance


def cvode_pieces(e: Equations, family: str) -> Advance:
    """CVODE by the `family` of methods."""
    from sksundae.cvode import CVODE

    def advance(contact: bool, begin: float, y: Array, times: Array) -> Piece:
        def right(t: float, state: Array, out: Array) -> None:
            e.rates(contact, t, state, out)

        def slopes(t: float, state: Array, _rates: Array, out: Array) -> None:
            out[:] = e.jacobian(contact, state)

        def watched(t: float, state: Array, out: Array) -> None:
            out[0] = e.surface(contact, begin, t, state)

        watched.direction = [1]  # type: ignore[attr-defined]
        # a new one for each piece: the library keeps, and reads again, every event that one has found
        cvode: Any = CVODE(
            right,
            method=family,
            rtol=e.tolerance,
            atol=e.absolute,
            jacfn=slopes,
            eventsfn=watched,
            num_events=1,
            max_num_steps=MOST_STEPS,
        )
        cvode.init_step(begin, y)
        samples: list[Array] = []
        for time in times:
            found = cvode.step(time, tstop=times[-1])
            if not found.success:
                raise e.failed(found.t, found.y, f"CVODE {family}: {found.message}")
            if found.status == 2:  # a root
                break
            samples.append(found.y)
        event = len(samples) < len(times)
        end = found.t if event else times[-1]
        passed = np.array(samples).reshape(-1, 2 * e.n)
        return Piece(float(end), np.array(found.y), event, passed, int(found.nfev))

    return advance


def heyoka_pieces(e: Equations) -> Advance:
    """heyoka's Taylor integrator with terminal events."""
    import heyoka as hy

    numbers = np.concatenate([e.modes.ravel(), e.scalars, [e.rounding, 0.0]])

    def made(contact: bool) -> Heyoka:
        kept = _kept.__dict__.setdefault("integrators", {})
        kind = (e.n, contact, contact and e.hertz, e.tolerance)
        if kind not in kept:
            kept[kind] = _compiled(*kind)
        kept[kind].pars[:] = numbers[: kept[kind].pars.size]  # up to the last one that occurs
        kept[kind].reset_cooldowns()
        return kept[kind]

    def advance(contact: bool, begin: float, y: Array, times: Array) -> Piece:
        taylor, sigma = made(contact), contact and e.hertz
        taylor.time = 0.0 if sigma else begin
        taylor.state[:] = [*y, math.sqrt(max(0.0, e.tip(y)[0])), begin] if sigma else y
        samples: list[Array] = []
        spent, event, end = 0, False, begin
        for target in times:
            if sigma:
                taylor.pars[-1] = target
                taylor.reset_cooldowns()
            # in sigma the target ends the stretch as the second event
            outcome, _h, _low, steps, *_rest = (
                taylor.propagate_for(FAR, max_steps=MOST_STEPS)
                if sigma
                else taylor.propagate_until(target, max_steps=MOST_STEPS)
            )
            spent, event = spent + steps, int(outcome) == -1
            end = float(taylor.state[-1] if sigma else taylor.time)
            if event:
                break
            if int(outcome) != -2 and outcome != hy.taylor_outcome.time_limit:
                raise e.failed(end, taylor.state[: 2 * e.n], f"heyoka: {outcome!r}")
            samples.append(taylor.state[: 2 * e.n].copy())
        passed = np.array(samples).reshape(-1, 2 * e.n)
        return Piece(end if event else float(times[-1]), taylor.state[: 2 * e.n].copy(), event, passed, spent)

    return advance


def heyoka_equations(
    modes: list[Heyoka], scalars: list[Heyoka], contact: bool = False, sigma: bool = False
) -> tuple[list[Heyoka], Heyoka]:
    """The equations of a flight, a linear contact, or a Hertz contact in sigma, and the penetration [m].

    `modes` and `scalars`, as in `rates` of ``piecewise``, are numbers, or parameters at plan time.  The last
    two equations in sigma are of s and t.
    """
    import heyoka as hy

    (stiffness, decay, phi, push), (frequency, phase, gap, number) = modes, scalars
    every = range(len(phi))
    q, v = ([hy.expression(f"{name}_{k:03d}") for k in every] for name in "qv")
    s, clock = hy.make_vars("s", "t")
    shake = hy.sin(frequency * (clock if sigma else hy.time) + phase)
    depth = hy.sum([phi[k] * q[k] for k in every]) - gap
    force = number * s * s * s if sigma else number * depth
    stretch = s if sigma else 1.0
    pulls = [
        [push[k] * shake, -decay[k] * v[k], -stiffness[k] * q[k], *([-phi[k] * force] if contact else [])]
        for k in every
    ]
    system = [(q[k], stretch * v[k]) for k in every]
    system += [(v[k], stretch * hy.sum(pulls[k])) for k in every]
    if sigma:
        system += [(s, 0.5 * hy.sum([phi[k] * v[k] for k in every])), (clock, s)]
    return system, depth


def _compiled(n: int, contact: bool, sigma: bool, tolerance: float) -> Heyoka:
    """heyoka's integrator for a flight, a linear contact, or a Hertz contact in sigma."""
    import heyoka as hy

    *scalars, rounding, target = (hy.par[4 * n + i] for i in range(6))
    modes = [[hy.par[i * n + k] for k in range(n)] for i in range(4)]
    system, depth = heyoka_equations(modes, scalars, contact, sigma)
    rising, falling = hy.event_direction.positive, hy.event_direction.negative
    if sigma:
        (s, _), (clock, _) = system[-2:]
        watched = [(s, falling), (clock - target, rising)]
    else:
        watched = [(depth, falling)] if contact else [(depth - rounding, rising)]
    return hy.taylor_adaptive(
        system,
        [0.0] * len(system),
        tol=tolerance,
        t_events=[hy.t_event(surface, direction=way) for surface, way in watched],
    )
