"""In touch with the stop: one file a law, chosen by the table `LAWS`.

`newton`, `delayed`, `linear`, `power`   the laws; `power` serves three of them, one in `power_law`
`passage`                                a touch from strike to release, under any law, and its record
`series`, `time_series`                  power series of a contact: what force laws share; in time
`exchange`                               work, impulse and largest force of a step
`tangent_series`                         tangents through a touch
`impulses`, `sets`, `rests`              several stops: impulses at one instant; contacts followed together;
                                         which points stay at rest

A new law is one file here, a line in `LAWS` and an export (CONTRIBUTING.md, "Add a contact law").  The file
has a frozen dataclass of the parameters, a ``contact.laws.ContactLaw`` with `@final`, and the names below.
Its `code` is a number that no other law has: 0 to 3 are taken, and 9 belongs to a test.  For a force that is
a polynomial in d and d' follow ``linear``: `force`, `stiffness`, `step` and `slopes` are new, and `joins` and
`coefficient` are left out.  `step` computes N[n] from d[0] ... d[n + 1], by products of series, and calls
`extend` for the next order.  A force with a root at d = 0 needs a variable in which it has none: ``power``.
Read `ContactLaw`, ``time_series``, `Series` and `product` in ``series``, `Weights` in ``tangent_series``.

What a file offers.  `numbers` is the oscillator, `run` the state of the motion
(``contact.touch.passage.STATE``), (u, v) are the deviations, and `series` is the workspace of one step.
    LAW, METHOD                               the law in words; a name for `method=`, which laws may share
    REGIMES                                   where the tip can be: ``contact.state.Regime``
    series_size(numbers) -> order, columns     size of the workspace of one step
    strike(numbers, run, u, v, approach) -> regime, rebound, loss, impulse
                                              the immediate effect of a touch: the regime that follows, the
                                              tip velocity after it (NaN if not known yet) [m/s], the energy
                                              lost [J] and the impulse of the stop (NaN if none acts at once)
                                              [N s]; before SUSTAINED, run.memory0 is the time until rest [s]
    step(numbers, run, u, v, limit, series) -> s, h, regime
                                              computes the series from (u, v) and a step of at most `limit`
                                              [s]: its length s in the law's own variable, its length h [s],
                                              and the regime that follows; NaN if the series gives no step
    series_variable(numbers, t, s, series)     the variable of the series a time t [s] into a step up to s
    state(numbers, run, s, series, u, v)       writes the deviations there into (u, v)
    exchange(numbers, run, span, series, known) -> work, impulse, force
                                              what the tip gives to the stop in a step up to span[1]: work
                                              [J], impulse [N s], and the larger of `known` and the largest
                                              force from span[0] on [N] (``contact.touch.exchange``)
    height_over(numbers, run, weight, own, series, out) -> order
                                              the series of the height over another stop in this step, in the
                                              law's variable, from its `weight` of the modes and its `own`
                                              numbers as in a stack (``contact.flight.numbers``); 0 if
                                              no other stop can be reached
    joins(numbers) -> bool                    whether contacts of this law are followed together with others
                                              (``contact.touch.sets``), with the next function; then number0
                                              must be dN/dd at d = 0; not if it is left out
    coefficient(numbers, n, depth) -> N       order n of the series of N in time, from that of d up to n + 1
    leave(numbers, run, u, v) -> velocity      sets run.contact_order for the flight after the release; the
                                              tip velocity there [m/s]
    force(numbers, d, d') -> N                 for the methods with a time step, at d >= 0
    stiffness(numbers, d, d') -> dN/dd, dN/dd'
    slopes(numbers, run, series, weights) -> terms
                                              fills the series that the tangents need
                                              (``contact.touch.tangent_series.Weights``); returns the number
                                              of terms of the first three
    saltation(numbers, vary, before, after, tangent)
                                              the immediate effect of a touch on the tangents; `before` and
                                              `after` are (drive time, u, v)
    inside(numbers, vary, now, length, tangent)
                                              the effect on the tangents, beyond the series, of a touch that
                                              has lasted a time `length` [s]; `now` is (drive time, u, v)
    acceleration(numbers, free, q, rate)      d^2 u/dt^2 in touch at a strobe, shape (n_modes,), from that of
                                              `free` modes and the modal state (q, q')
    repeated_touch(numbers, speed, m)         in closed form, the touch that repeats after m drive periods,
                                              as (jump, duration, leaves) of ``single_impact.Kick``, or None
The last two are plain functions.  What a file leaves out is that of ``contact.touch.time_series``, or else
that of ``contact.touch.series``.

An unknown code is an error wherever a law is needed.  A kernel takes no functions as arguments; `by_law`
therefore links the files of the table into one compiled function for each name.
"""

import inspect
from collections.abc import Callable
from functools import partial
from types import ModuleType, SimpleNamespace
from typing import Any, TypeVar

from contact.laws import LINEAR, NEWTON, POWER
from contact.machine.compiled import part
from contact.touch import delayed, linear, newton, power, series, time_series

Function = TypeVar("Function", bound=Callable[..., object])


def offered(file: ModuleType) -> SimpleNamespace:
    """What the file of a law offers, and for the rest what most laws share."""
    law = SimpleNamespace(**vars(series) | vars(time_series) | vars(file))
    law.acceleration = getattr(file, "acceleration", partial(series.acceleration, law.force))
    return law


LAWS = {
    NEWTON: offered(newton),
    delayed.DELAYED: offered(delayed),
    LINEAR: offered(linear),
    POWER: offered(power),
}
"""The laws by their codes."""


def by_law(functions: dict[int, Function]) -> Function:
    """The function of numbers.law: `if numbers.law == ...: return ...` for each code, then an error."""
    names = {f"law_{code}": function for code, function in functions.items()}
    arguments = list(inspect.signature(next(iter(functions.values()))).parameters)
    lines = [f"def chosen({', '.join(arguments)}):"]
    for code in functions:
        lines.append(f"    if {arguments[0]}.law == {code}: return law_{code}({', '.join(arguments)})")
    lines.append('    raise NotImplementedError("the contact law is in no table: see contact.touch")')
    exec("\n".join(lines), names)
    return part(names["chosen"])


def _compiled(name: str) -> Callable[..., Any]:
    """The compiled function of this name, under any law."""
    return by_law({code: getattr(law, name) for code, law in LAWS.items()})


strike, force, stiffness, saltation, inside, slopes, state, series_size, series_variable = map(
    _compiled, "strike force stiffness saltation inside slopes state series_size series_variable".split()
)
joins, coefficient = map(_compiled, ("joins", "coefficient"))
"""The functions of numbers.law that are needed beside the steps of a touch (``contact.touch.passage``)."""
