"""In touch with the stop: one file a law, chosen by the table at the end of this one.

How to add a law, say N = k d^3
    1. Its parameters: a frozen dataclass that is a ``contact.laws.ContactLaw``, with a `code` that no other
       has and its `numbers`.
    2. Its file here, with the names below.  A force that has a power series in time takes most of them from
       ``contact.touch.time_series``: it fills N[n] from d[0] ... d[n] (for the cube by two products of
       series), calls `extend` for the next order, and asks `longest_step` how far the series holds.  One
       with a root at d = 0 needs a variable in which it has none: ``contact.touch.hertz``.
    3. Its line in `TOUCHES`.
    4. A test: the contact of a free mass conserves energy, and agrees with an outside solver.

What a file offers.  `motion` is the oscillator, `run` where it stands (``contact.engine.event_loop.STATE``),
(u, v) its deviations, `series` the room of one step.
    LAW                                       its name in words
    REGIMES                                   where the tip can be: ``contact.trajectory.Regime``
    room(motion) -> order, columns            size of the room of a step
    strike(motion, run, u, v, approach) -> regime, rebound, loss
                                              what the touch does at once: the regime that follows, the tip
                                              velocity after it (NaN if not known yet) [m/s], energy lost [J]
    step(motion, run, u, v, limit, series) -> s, h, regime
                                              the series from (u, v), and a step of at most `limit` [s]: its
                                              length in the law's own variable and in time, and the regime
                                              that follows; NaN if the series gives no step
    place(motion, t, s, series) -> s          where in a step up to s a time t [s] lies
    state(motion, run, s, series, u, v)       puts the deviations there into (u, v)
    work(motion, run, s, series) -> energy    what the stop has taken up to there [J]
    leave(motion, run, u, v)                  the release: run.order, how many derivatives of d vanish
    force(numbers, d, d') -> N                for the methods with a time step, at d >= 0
    stiffness(numbers, d, d') -> dN/dd, dN/dd'
    slopes(motion, run, series, weights) -> terms
                                              for the tangents: the series of dt/ds, dN/dd dt/ds and dN/dd'
                                              dt/ds in three rows, and how many terms they have; behind them
                                              those of N dt/ds and its derivatives with respect to the numbers
    saltation(motion, vary, before, after, tangent)
                                              for the tangents: what the touch does besides; (drive time, u,
                                              v) before and after it

A code that no file has is an error wherever a law is asked for.  Compiled code takes no functions as
arguments: `by_law` links the files of the table into one kernel for each function.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TypeVar

from contact.laws import DELAYED, HERTZ, LINEAR, NEWTON
from contact.machine.compiled import part
from contact.touch import delayed, hertz, linear, newton

Function = TypeVar("Function", bound=Callable[..., object])

TOUCHES = {NEWTON: newton, DELAYED: delayed, LINEAR: linear, HERTZ: hertz}
"""The file of each law by its code."""


def by_law(functions: dict[int, Function]) -> Function:
    """The function of motion.law: `if motion.law == ...: return ...` for each code, then an error."""
    names = {f"law_{code}": function for code, function in functions.items()}
    arguments = list(inspect.signature(next(iter(functions.values()))).parameters)
    lines = [f"def chosen({', '.join(arguments)}):"]
    for code in functions:
        lines.append(f"    if {arguments[0]}.law == {code}: return law_{code}({', '.join(arguments)})")
    lines.append('    raise NotImplementedError("the contact law is in no table: see contact.touch")')
    exec("\n".join(lines), names)
    return part(names["chosen"])


room, strike, step, place, state, work, leave, force, stiffness, slopes, saltation = (
    by_law({code: getattr(file, name) for code, file in TOUCHES.items()})
    for name in (
        "room",
        "strike",
        "step",
        "place",
        "state",
        "work",
        "leave",
        "force",
        "stiffness",
        "slopes",
        "saltation",
    )
)
