"""Public calls of `contact.orbits`: right arguments and wrong values; how it is written: calls_of_beam."""

import dataclasses

import numpy as np
from calls_of_beam import INF, NAN, each, of, says
from calls_of_contact import EQ_1, LOADED, OFF_STROBE, THREE_MODES, TWO_STOPS, UNDRIVEN, at, nordmark
from cases_of_calls import GAP, HERTZ, NEWTON

import contact
from contact import Regime, orbits
from contact.touch.passage import Touches

# an orbit of another period, of the same one with more touches, and of an oscillator with another gap
P4 = says(dataclasses.replace(HERTZ.family, m=4).at_speed(0.1), "has 4 drive periods; it must have 5")
TWICE = says(
    dataclasses.replace(HERTZ.orbit, record=Touches(*(np.repeat(each, 2, 0) for each in HERTZ.orbit.record))),
    "has 2 touches",
)
WIDER = dataclasses.replace(HERTZ.oscillator, stop=contact.Stop(gap=0.0108, law=HERTZ.oscillator.stop.law))
FOREIGN = says(
    dataclasses.replace(HERTZ.family, oscillator=WIDER).at_speed(HERTZ.speed),
    "oscillator of the start is not",
)


CHANGE = orbits.Change(gap=1.0, frequency=1e3)
IDLE = says(
    dataclasses.replace(EQ_1, model=dataclasses.replace(EQ_1.model, participation=[0.0])),
    "the drive does not move the tip",
)
NO_MAP = each(None, NEWTON.oscillator)
NO_FAMILY = each(None, EQ_1)
KICK_CALLS = {
    "orbit": lambda c: dict(speed=c.speed),
    "orbit_of": lambda c: dict(kick=c.kicks.kick(c.speed)),
    "excess": lambda c: dict(speed=c.speed),
    "closed": lambda c: dict(jump=c.kicks.kick(c.speed).jump),
}
SHOOTING_CALLS = {
    "unknowns": lambda c: dict(start=c.family.orbit(c.speed).deviations, speed=c.speed),
    "equations": lambda c: dict(x=c.family.unknowns(c.family.orbit(c.speed).deviations, c.speed)),
    "fold": lambda c: {},
    "orbits": lambda c: dict(excess=0.01),
}
DERIVATIVES = {"orbit_derivatives": orbits.orbit_derivatives, "excess_derivatives": orbits.excess_derivatives}

# fmt: off
ORBITS = (
    of(orbits.KickFamily, lambda: dict(oscillator=EQ_1, m=5),
       kind=dict(oscillator=None), value=dict(m=each(0, 2.5), oscillator=each(LOADED, IDLE, TWO_STOPS))),
    of(orbits.KickFamily.fold, lambda c: dict(self=c.kicks), over="family",
       kind=dict(speeds="all"), value=dict(speeds=each((0.5, 0.01), (0.0, 1.0)))),
    of(orbits.KickFamily.orbits, lambda c: dict(self=c.kicks, excess=0.01), over="family"),
    of(orbits.KickFamily.kick, lambda c: dict(self=c.kicks, speed=c.speed), over="speeds",
       kind=dict(speed="fast"), value=dict(speed=each(0.0, -1.0, INF))),
    of(orbits.KickFamily.orbit_of, lambda c: dict(self=c.kicks, kick=c.kicked.kick), over="family",
       name="KickFamily.orbit_of, refused", kind=dict(kick=each(None, HERTZ.kicked))),
    *(of(getattr(orbits.KickFamily, name), lambda c, given=given: dict(self=c.kicks) | given(c),
         name=f"KickFamily.{name}", over="speeds") for name, given in KICK_CALLS.items()),
    of(orbits.Shooting, lambda: dict(oscillator=HERTZ.oscillator, m=5),
       kind=dict(oscillator="eq_1"),
       value=dict(m=each(0, 1.5), impacts=0, oscillator=each(UNDRIVEN, IDLE, TWO_STOPS))),
    of(orbits.Shooting.orbit, lambda c: dict(self=c.family, speed=c.speed),
       name="Shooting.orbit", over="speeds"),
    of(orbits.Shooting.at_speed, lambda c: dict(self=c.family, speed=c.speed),
       name="Shooting.at_speed", over="speeds",
       kind=dict(speed=None, near=3), value=dict(speed=each(0.0, -0.1), near=P4)),
    of(orbits.Shooting.at_speed, lambda c: dict(
           self=orbits.Shooting(oscillator=c.oscillator, m=2, impacts=3), speed=2 * c.speed),
       name="Shooting.at_speed, three touches", over="family"),
    of(orbits.Shooting.at_excess, lambda c: dict(self=c.family, excess=1.01 * c.orbit.excess, near=c.orbit),
       name="Shooting.at_excess", over="speeds", kind=dict(near=None),
       value=dict(excess=each(-1.5, NAN), near=P4)),
    of(orbits.Shooting.at_excess, lambda c: dict(self=c.family, excess=0.01, near=c.orbit),
       name="Shooting.at_excess, far away", over="speeds"),
    of(orbits.Shooting.from_state, lambda c: dict(
           self=orbits.Shooting(oscillator=c.driven, m=5), state=c.state),
       name="Shooting.from_state", over="family"),
    *(of(getattr(orbits.Shooting, name), lambda c, given=given: dict(self=c.family) | given(c),
         name=f"Shooting.{name}", over="family") for name, given in SHOOTING_CALLS.items()),
    *(of(getattr(orbits.PeriodicOrbit, name), lambda c: dict(self=c.orbit), name=f"PeriodicOrbit.{name}",
         over="speeds") for name in ("state", "monodromy", "release", "repeats", "strobe_state")),
    of(orbits.follow, lambda c: dict(family=c.family, start=c.orbit, low=0.5 * c.speed, high=2.0 * c.speed,
                                     step=0.3), over="speeds",
       kind=dict(family=None, start=0.1),
       value=dict(low=each(says(0.2, "low and high are 0.2 and"), says(0.0, "low and high are 0.0 and")),
                  start=each(P4, TWICE, FOREIGN), high=says(0.06, "low and high are"),
                  step=says(0.0, "step is 0.0 [1]"))),
    of(orbits.first_event, lambda c: dict(family=c.family, start=c.orbit, lowest=-0.5), over="family",
       kind=dict(family=None, start=0.1), value=dict(lowest=-1.5, start=each(P4, TWICE, FOREIGN))),
    of(orbits.fold_of, lambda c: dict(family=c.family), over="family", kind=dict(family=NO_FAMILY, near=0.1),
       value=dict(near=P4)),
    of(orbits.fold_of, lambda c: dict(family=c.family, near=c.orbit), name="fold_of, near an orbit",
       over="family"),
    of(orbits.fold_along_frequency, lambda c: dict(family=c.family, frequencies=np.array([22.2])),
       over="family", kind=dict(family=5, frequencies=["22.2"]), value=dict(frequencies=each(22.2, [NAN]))),
    of(orbits.follow_path, lambda c: dict(
           path=c.oscillator.with_excess, start=c.orbit, at=c.orbit.excess, low=c.orbit.excess,
           high=c.orbit.excess + 0.05, step=1.0), over="family",
       kind=dict(start=0.1), value=dict(
           path=says(None, "path is None; it must be a function"), at=says(0.3, "at is 0.3 [of p]"),
           low=NAN, high=says(-0.2, "high is -0.2 [of p]"), step=says(0.0, "step is 0.0 [1]"))),
    of(orbits.Change, dict(gap=1.0, frequency=0.0, amplitude=0.0, law=(0.0, 0.0)),
       kind=dict(model=EQ_1.model, law=each("soft", ("1", 0.0))), value=dict(law=each((1.0,), (NAN, 0.0)))),
    *(of(call, lambda c: dict(orbit=c.orbit, changes=[CHANGE]), name=name, over="family",
         kind=dict(orbit=each(None, 0.1), changes=each(CHANGE, 3.0, ["gap"])))
      for name, call in DERIVATIVES.items()),
    of(orbits.motion_derivatives, lambda c: dict(
           oscillator=c.driven, state=c.state, changes=[CHANGE], periods=3, times=np.linspace(0.01, 0.1, 5)),
       over="starts", kind=dict(oscillator=None, state=[0.0], changes=each(CHANGE, [3.0])),
       value=dict(oscillator=each(UNDRIVEN, TWO_STOPS), state=says(at(GAP, Regime.CONTACT), "regime"))),
    *(of(orbits.settle, lambda c, prove=prove: dict(
             strobed=c.strobed, state=c.state, most_cycles=256, largest_m=64, tolerance=1e-9,
             prove=prove),
         name=name, over="starts", kind=dict(strobed=NO_MAP),
         value=dict(largest_m=0, most_cycles=-1, tolerance=-1.0))
      for name, prove in {"settle": True, "settle, unproved": False}.items()),
    *(of(call, lambda c: dict(strobed=c.strobed, excess=1e-3, most_cycles=256), over="motion",
         kind=dict(strobed=NO_MAP), value=dict(excess=-2.0, most_cycles=-1, below=each(0.5, 0.0, NAN)))
      for call in (orbits.onset_orbit, orbits.onset_m)),
    of(orbits.fold_excess, lambda c: dict(strobed=c.strobed, m=5), over="motion",
       kind=dict(strobed=each(*NO_MAP, 5)), value=dict(m=2.5)),
    of(orbits.orbit_end, lambda c: dict(
           strobed=c.strobed, state=c.fast, excess=0.02, most_cycles=512, first_step=2e-4, relative=0.01,
           absolute=1e-7, lowest=-0.5), over="motion",
       kind=dict(strobed=EQ_1), value=dict(first_step=0.0, absolute=0.0, relative=-1.0, lowest=-1.0)),
    of(orbits.orbit_diagram, lambda c: dict(
           strobed=c.strobed, excesses=[1e-3, -1e-3], state=c.state, observe=c.strobed.tip, settle_cycles=128,
           record_cycles=40, largest_m=64), over="starts",
       kind=dict(strobed=EQ_1, excesses="1", observe=each(3, says(lambda p: "tip", "observe(points) is"))),
       value=dict(observe=says(lambda p: p, "observe(points) has shape"), settle_cycles=-1,
                  excesses=each(says([], "excesses is empty"), [[1e-3]]))),
    of(orbits.AmplitudeScan, lambda: dict(oscillator=EQ_1, most_cycles=128),
       kind=dict(oscillator=each(None, nordmark())),
       value=dict(oscillator=each(UNDRIVEN, TWO_STOPS), most_cycles=127)),
    of(lambda **given: orbits.AmplitudeScan(oscillator=EQ_1, most_cycles=128)(**given),
       dict(frequency=22.2, excesses=[-1e-3]), name="AmplitudeScan, a column", kind=dict(excesses="all"),
       value=dict(frequency=0.0, excesses=says([1e-3, 0.0], "excesses must be"))),
    of(orbits.strobe_derivatives, lambda c: dict(strobed=c.below, state=c.below.steady(), m=2),
       over="motion", kind=dict(strobed=None, state=[0.0, 0.0]),
       value=dict(m=each(0, 1.5), state=OFF_STROBE)),
    of(orbits.strobe_covariance, lambda c: dict(
           strobed=c.below, state=c.below.steady(), m=2, deviation=1e-3, memory=0.5), over="motion",
       kind=dict(strobed=3.0), value=dict(deviation=each(-1e-4, NAN), memory=each(1.0, -0.1, NAN), m=0)),
    of(orbits.map_exponents, lambda c: dict(strobed=c.strobed, state=c.state, count=5, align=0),
       over="starts", kind=dict(strobed=each(None, EQ_1)), value=dict(count=1, align=-1)),
    of(orbits.orbit_exponents, lambda c: dict(strobed=c.below, state=c.below.steady(), m=2),
       over="motion", kind=dict(strobed=None), value=dict(m=each(0, 1.5), state=THREE_MODES)),
    of(orbits.orbit_exponents, lambda c: dict(strobed=c.strobed, state=c.state, m=5),
       name="orbit_exponents, of no orbit", over="starts"),
)
# fmt: on
