"""The passage of a touch, from its strike to its release, for motions and for their tangents.

A touch begins with the strike: the law acts at once (`begin`, `meet`).  If the law then keeps the tip on the
wall, the contact is followed step by step until it releases the tip (`follower`).  The event loop
(``contact.engine.event_loop``) and the flow with tangents (``contact.sensitivity.touch_flow``) go this same
way.  They differ only in what they do at each step, the *watch*: one takes samples, the other carries the
tangents along.
"""

import math
from collections.abc import Callable
from types import ModuleType

import numpy as np

from contact import touch
from contact.flight.elementary import EPS
from contact.flight.modal_flow import hold, tip_state
from contact.machine.compiled import part
from contact.touch.record import add_loss, close_touch, open_touch
from contact.trajectory import GRAZE, IMPACT, OUTSIDE, STAY, SUSTAINED

STATE = np.dtype(
    [(name, "i8") for name in ("regime", "contact_order", "period", "evaluations", "steps")]
    + [(name, "f8") for name in ("clock", "wait", "rebound", "memory0", "memory1")]
)
"""The state of a motion besides its deviations: ``contact.trajectory.State`` for kernels.

regime, wait, rebound: as there; contact_order: number of derivatives of the tip displacement that vanish at
the start of the flight; period, clock: number of the drive period and time since its strobe [s]; evaluations:
flights, contact steps and sampled positions so far; steps: flights and contact steps since the strobe;
memory0, memory1: what the law keeps of the touch under way for itself, negative when to be computed anew.
"""

RELEASED, AT_END, TOO_MANY, NO_STEP = range(4)
"""How a contact is left: by its release; at the end of the time; with too many steps; with a step of no
length."""

CLOSEST = 4.0 * EPS  # part of a drive period next to the end in which no step is made

Watch = Callable[[ModuleType], Callable[..., None]]
"""From the file of a law to watch(motion, run, u, v, s, until, series, watcher): what is done at each step.
The step leads from (u, v) at the clock of the run to `s`, in the law's own variable, at the clock `until`."""


@part
def begin(motion, run, u, v, touches):
    """The strike of a touch: the law acts at once; returns the approach and the rebound velocity [m/s].

    The touch is written into the record `touches`, and closed unless the contact lasts.
    """
    approach = tip_state(motion, run.clock, u, v)[1]
    open_touch(touches, run.period, run.clock, approach, IMPACT, u, v)
    run.regime, rebound, loss = touch.strike(motion, run, u, v, approach)
    add_loss(touches, loss)
    if run.regime == OUTSIDE or run.regime == SUSTAINED:
        close_touch(touches, run.period, run.clock, rebound, u, v)
    return approach, rebound


@part
def meet(motion, run, u, v, crosses, touches):
    """A flight has met the stop: a touch begins, or with `crosses` false it is a graze, without effect.

    Accumulated impacts become a stay: their last hops are left out, and the energy of these is its loss.
    """
    if not crosses:
        open_touch(touches, run.period, run.clock, 0.0, GRAZE, u, v)
        close_touch(touches, run.period, run.clock, 0.0, u, v)
        run.contact_order = 2
    else:
        _approach, rebound = begin(motion, run, u, v, touches)
        if run.regime == SUSTAINED:
            open_touch(touches, run.period, run.clock, rebound, STAY, u, v)
            add_loss(touches, 0.5 * rebound * rebound / motion.inverse_mass)
            hold(motion, run.clock, u, v)


def _follow(file: ModuleType, watch: Callable[..., None]) -> Callable[..., int]:
    """`follower` for one law, so that the law is looked up once a touch and not once a step."""
    step, state, leave = file.step, file.state, file.leave

    def follow(motion, u, v, run, end, most, touches, series, watcher):
        """Follow a contact to its release, or to the clock `end`; returns how it is left.

        At most `most` steps are made since the strobe.  A release is written into the record `touches`.
        """
        while end - run.clock > CLOSEST * motion.period:
            s, h, following = step(motion, run, u, v, end - run.clock, series)
            run.evaluations += 1
            run.steps += 1
            if run.steps > most:
                return TOO_MANY
            if not (0.0 <= h < math.inf):
                return NO_STEP
            until = run.clock + h if h < end - run.clock else end
            watch(motion, run, u, v, s, until, series, watcher)
            state(motion, run, s, series, u, v)
            run.regime, run.clock = following, until
            if following == OUTSIDE:
                velocity = leave(motion, run, u, v)
                close_touch(touches, run.period, run.clock, velocity, u, v)
                return RELEASED
        return AT_END

    return part(follow)


def follower(watch: Watch) -> Callable[..., int]:
    """The compiled way through a contact under any law, with a `watch` on each step."""
    return touch.by_law({code: _follow(file, watch(file)) for code, file in touch.TOUCHES.items()})
