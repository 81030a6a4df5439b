"""Right calls of `contact` and wrong values for their arguments; how it is written: wrong_input_of_beam."""

from __future__ import annotations

import contextlib
import dataclasses
from functools import cache
from typing import Any

import numpy as np
from wrong_input_of_beam import INF, NAN, each, fields_of, of, told

import beam
import contact
from contact import Regime, integrators
from contact import orbits as periodic
from contact.orbits.branches import continuation, path
from contact.orbits.families import kick, shooting
from contact.orbits.observation import lyapunov


@cache
def eq_1(law: contact.ContactLaw | None = None) -> contact.ImpactOscillator:
    return contact.ImpactOscillator(
        model=beam.single_mode(free_period=40.8e-3, decay_rate=3.56),
        stop=contact.Stop(gap=0.0107, law=law or contact.NewtonRestitution(local_restitution=0.1)),
        drive=contact.HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)


@cache
def strobed() -> contact.StroboscopicMap:
    oscillator = eq_1()
    model = dataclasses.replace(oscillator.model, readouts={"laser": [1.0]})
    return contact.StroboscopicMap(oscillator=dataclasses.replace(oscillator, model=model))


@cache
def nordmark() -> contact.NordmarkMap:
    return contact.NordmarkMap(alpha=0.5, gamma=0.8, restitution=0.1)


@cache
def bent() -> contact.NonlinearMode:
    return contact.NonlinearMode(
        free_period=40.8e-3,
        decay_rate=3.56,
        stiffness=-100.0,
        inertia=90.0,
        gap=0.0107,
        restitution=0.1,
        frequency=22.2,
        excess=0.01,
    )


@cache
def closed() -> contact.MaximalFamily:
    return contact.MaximalFamily.from_oscillator(eq_1(), period=5)


@cache
def family() -> shooting.Shooting:
    return shooting.Shooting(oscillator=eq_1(contact.HertzContact(stiffness=8e9)), period=5)


@cache
def orbit() -> shooting.PeriodicOrbit:
    return family().at_speed(0.1)


def unless_refused(derivatives: Any) -> Any:
    """The derivatives of an event, of an orbit that need not be one."""

    def call(orbit: Any, changes: Any) -> None:
        with contextlib.suppress(contact.NoDerivative):
            derivatives(orbit, changes)

    return call


@cache
def system() -> Any:
    return dataclasses.replace(nordmark(), control=0.01)


def at(displacement: float, regime: Regime = Regime.OUTSIDE) -> contact.State:
    """A resting state of Eq. (1), [m]."""
    phi = float(eq_1().model.phi[0])
    return contact.State(displacement=[displacement / phi], velocity=[0.0], regime=regime)


GAP = eq_1().stop.gap
LOADED = dataclasses.replace(eq_1(), load=np.array([1.0]))
UNDRIVEN = dataclasses.replace(eq_1(), drive=None)
IDLE = dataclasses.replace(eq_1(), model=dataclasses.replace(eq_1().model, participation=[0.0]))
RESTING = dataclasses.replace(UNDRIVEN, stop=contact.Stop(gap=0.0, law=eq_1().stop.law))
CHANGE = periodic.Change(gap=1.0)
FINAL = (
    beam.ModalChange,
    beam.ModalModel,
    contact.HarmonicDrive,
    contact.ImpactOscillator,
    contact.State,
    contact.Stop,
    periodic.Change,
    *contact.ContactLaw.__subclasses__(),
)
PAIR = dict(radius=0.0025, youngs_modulus=370e9, poissons_ratio=0.22, other_modulus=210e9, other_ratio=0.29)
BAND = dict(free_period=40.8e-3, decay_rate=3.56, restitution=0.1)
FROM_F = dict(drive_frequency=22.2, **BAND)
START = dict(displacement=[0.0], velocity=[0.0])

# fmt: off
CONTACT = (
    of(lambda parent: type("Own", (parent,), {}), dict(parent=contact.ContactLaw), name="final classes",
       kind=dict(parent=each(*(told(one, f"is a subclass of {one.__name__};") for one in FINAL)))),
    of(contact.HarmonicDrive, dict(frequency=22.2, amplitude=1e-3),
       kind=dict(frequency="22.2 Hz"), value=dict(frequency=0.0, amplitude=-1e-3)),
    of(contact.Stop, dict(gap=0.0107, law=contact.NewtonRestitution(local_restitution=0.1)),
       kind=dict(gap="10.7 mm", law=each(None, 0.1, "newton", contact.HertzContact)), value=dict(gap=-0.01)),
    of(contact.NewtonRestitution, dict(local_restitution=0.1),

       kind=dict(local_restitution=each("0.1", None)),
       value=dict(local_restitution=each(1.1, 1.0000001, -1e-12, NAN))),
    of(contact.DelayedRestitution, dict(restitution=0.1, delay=1e-4),
       kind=dict(restitution=each("soft", None, told(lambda v: "soft", "m/s is 'soft'")),
                 delay=each("late", None, [1e-4])),
       value=dict(restitution=each(2.0, 1.0000001, -0.01, -1e-12, NAN,
                                   told(lambda v: 1.2 - v, "restitution runs from"),
                                   told(lambda v: 0.5 if v < 1 else NAN, "restitution")),
                  delay=each(-1e-9, NAN, INF, told(lambda v: 1e-4 - v, "delay"),
                             told(lambda v: INF, "delay")),
                  speeds=each(told(3.0, "speeds has shape ()"), (1.0,), (1.0, 1.0), (0.0, 1.0), (1.0, NAN)))),
    of(contact.LinearContact, dict(stiffness=1e6, damping=0.0),
       kind=dict(stiffness=None, damping=None),
       value=dict(stiffness=each(0, 0.0, -1.0), damping=each(-1.0, -1e-300))),
    of(contact.HertzContact, dict(stiffness=8e9),
       kind=dict(stiffness=each("hard", None)), value=dict(stiffness=each(0, 0.0, -8e9, INF))),
    of(contact.HertzContact.of_bodies, PAIR,
       value=dict(radius=each(0.0, -1.0), youngs_modulus=each(0.0, -1.0), other_modulus=each(0.0, -1.0),
                  poissons_ratio=each(0.5000001, -1.0), other_ratio=each(0.6, 0.5000001, -1.0))),
    of(contact.HuntCrossley, dict(stiffness=8e9, dissipation=0.5),
       kind=dict(stiffness=None, dissipation=None),
       value=dict(stiffness=each(0, 0.0, -1.0), dissipation=each(-0.5, -1e-300, NAN))),
    of(contact.HuntCrossley.with_restitution, dict(stiffness=8e9, restitution=0.5, velocity=0.1),
       kind=dict(stiffness=None, restitution=each("half", None), velocity="fast"),
       value=dict(stiffness=each(0, -1.0), restitution=each(0.0, -0.5, -1e-12, 1.0000001),
                  velocity=each(0.0, -0.1, NAN))),
    of(contact.HuntCrossley.with_restitution, dict(stiffness=8e9, restitution=1.0, velocity=0.1),
       name="HuntCrossley.with_restitution, elastic", value=dict(stiffness=each(0, -1.0))),
    of(contact.ImpactOscillator, lambda: fields_of(eq_1()),
       kind=dict(model=None, stop=0.0107, drive=22.2, load=["a"]),
       value=dict(drive=told(contact.HarmonicDrive(frequency=22200.0), "drive is 22200 Hz"),
                  stop=told(dataclasses.replace(family().oscillator.stop, gap=0.0), "gap is 0.0 m"),
                  load=[1.0, 2.0])),
    of(lambda excess: eq_1().with_excess(excess), dict(excess=1e-3), name="ImpactOscillator.with_excess",
       kind=dict(excess="0.1 %"), value=dict(excess=each(-1.0, NAN))),
    of(lambda amplitude: eq_1().with_amplitude(amplitude), dict(amplitude=1e-3),
       name="ImpactOscillator.with_amplitude",
       kind=dict(amplitude=None), value=dict(amplitude=each(-1e-3, INF))),
    of(contact.State, START | dict(time=0.0, regime=0, wait=0.0, rebound=0.0),
       value=dict(displacement=each([], "rest", [NAN]),
                  velocity=each([0.0, 1.0], told([[0.0]], "velocity of the state")),
                  regime=each(7, -1, 5, 17), time=NAN)),
    of(contact.State.rest, dict(n_modes=2),
       kind=dict(n_modes="two"), value=dict(n_modes=each(0, 1.5))),
    of(contact.simulate, lambda: dict(oscillator=eq_1(), periods=2),
       kind=dict(oscillator=None, state=[0.0, 0.0], times="now", method=3),
       value=dict(periods=each(0, -2, 1.5, told(None, "duration and periods")),
                  oscillator=told(RESTING, "gap is 0.0 m"),
                  times=told([0.02, 0.01], "times is [0.02, 0.01] s"), method="magic",
                  state=each(told(contact.State.rest(3), "displacement of the state has 3 modes"),
                             told(at(1.0), "m behind the stop"), told(at(0.0, Regime.SUSTAINED), "regime"),
                             told(at(GAP, Regime.CONTACT), "regime"),
                             told(at(GAP, Regime.INSIDE), "regime")))),
    of(contact.simulate, lambda: dict(oscillator=eq_1(), duration=1.0), name="simulate for a duration",
       kind=dict(duration="1 s"),
       value=dict(duration=each(0.0, -1.0, NAN, told(1e12, "duration is 1e+12 s")),
                  periods=told(3, "duration and periods"),
                  times=each(told([0.2, NAN], "times holds nan s"), told([[0.2]], "times has shape"),
                             told([0.5, 1.1], "times run from"), told([-0.1, 0.5], "times run from")))),
    of(contact.StroboscopicMap, lambda: dict(oscillator=eq_1()), kind=dict(oscillator=3)),
    of(lambda excess: strobed().at(excess), dict(excess=1e-3), name="StroboscopicMap.at",
       value=dict(excess=-2.0)),
    of(lambda time, count: strobed().orbit(contact.State(**START, time=time), count), dict(time=0.0, count=1),
       name="StroboscopicMap.orbit", value=dict(count=each(-5, 2.5), time=1e-3)),
    of(lambda factors: strobed().orbit(strobed().steady(), 2, factors=factors), dict(factors=[1.0, 1.1]),
       name="StroboscopicMap.orbit, factors", kind=dict(factors=each("1", ["a", "b"])),
       value=dict(factors=each([1.0], [1.0, 0.0], [1.0, NAN], 1.0))),
    of(lambda points: strobed().tip(points), dict(points=[[0.0, 0.0]]), name="StroboscopicMap.tip",
       kind=dict(points="p"), value=dict(points=each([0.0, 0.0], np.zeros((2, 0)), [[0.0, 0.0, 0.0]]))),
    *(of(call, lambda: dict(state=strobed().steady()), name=name, kind=dict(state=[0.0, 0.0]),
         value=dict(state=told(contact.State.rest(3), "displacement of the state has 3 modes")))
      for name, call in {"StroboscopicMap.coordinates": lambda state: strobed().coordinates(state),
                         "StroboscopicMap.jacobians": lambda state: strobed().jacobians(state, 1)}.items()),
    of(lambda name: strobed().readout(np.zeros((1, 2)), name), dict(name="laser"),
       name="StroboscopicMap.readout", value=dict(name="no such point")),
    of(lambda maps, states, workers: contact.strobed_orbits(
           [strobed()] * maps, [contact.State(**START)] * states, 1, workers=workers),
       dict(maps=2, states=2, workers=2), name="strobed_orbits",
       value=dict(workers=0, maps=told(1, "states has 2 entries"),
                  states=each(told(0, "states has 0 entries"), told(3, "states has 3 entries")))),
    of(contact.NonlinearMode, lambda: fields_of(bent()),
       kind=dict(gap="1 cm", stiffness=None),
       value=dict(free_period=0.0, decay_rate=-1.0, gap=0.0, restitution=1.5, frequency=NAN, excess=-1.0,
                  stiffness=each(-1e4, INF), inertia=-1e4)),
    of(lambda state, count: bent().orbit(state, count), dict(state=[0.0, 0.0], count=0),
       name="NonlinearMode.orbit", kind=dict(state="rest"),
       value=dict(state=each([0.0, 0.0, 0.0], 0.0, [NAN, 0.0]), count=-1)),
    of(contact.NordmarkMap,
       dict(alpha=0.5, gamma=0.8, restitution=0.1, delay_term=0.0, whole_turns=1, control=0.01),
       kind=dict(restitution="0.1"),
       value=dict(alpha=1.9, gamma=each(1.5, -0.1, NAN), restitution=1.5, delay_term=-1.0,
                  y_line="wrong", whole_turns=0.5, control=NAN)),
    of(contact.NordmarkMap.from_frequencies, FROM_F,
       kind=dict(decay_rate="3.56"), value=dict(drive_frequency=25.0, free_period=0.0)),
    of(contact.NordmarkMap.from_mode,
       dict(omega=154.0, decay_rate=3.56, drive_frequency=22.2, restitution=0.1, delay=0.0),
       value=dict(omega=-154.0, delay=-1e-3, restitution=NAN)),
    of(contact.NordmarkMap.from_oscillator, lambda: dict(oscillator=eq_1()),
       kind=dict(oscillator=each(3, told(family().oscillator, "law of the stop is a HertzContact"))),
       value=dict(oscillator=told(UNDRIVEN, "drive is None"))),
    of(lambda state, rho, count: nordmark().iterate(state, rho, count),
       dict(state=[0.0, 0.0], rho=0.01, count=3), name="NordmarkMap.iterate",
       kind=dict(rho="0.01"), value=dict(state=each([0.0], [NAN, 0.0]), count=-1)),
    of(lambda state, count, factors: system().orbit(state, count, factors=factors),
       dict(state=[0.0, 0.0], count=3, factors=[1.0, 1.1, 1.2]), name="NordmarkMap.orbit",
       value=dict(state=each([0.0], [NAN, 0.0]), count=-1, factors=each([1.1], [1.0, 1.0, 0.0]))),
    of(contact.band, BAND | dict(period=4),
       kind=dict(period="p4"), value=dict(period=1, free_period=-1.0, whole_turns=-1, y_line=3)),
    of(contact.bands, BAND | dict(periods=(3, 4)),
       kind=dict(periods=3), value=dict(periods=told((3, 1), "period is 1 drive periods"), restitution=1.5)),
    of(contact.fold, lambda: dict(nordmark=nordmark(), period=4),
       kind=dict(nordmark=None), value=dict(period=each(0, 10**9))),
    of(contact.maximal_orbits, lambda: dict(nordmark=nordmark(), period=4, rho=0.01),
       kind=dict(nordmark=0.5), value=dict(period=2.5, rho=NAN)),
    of(contact.stable_range, lambda: dict(nordmark=nordmark(), period=4),
       kind=dict(nordmark="map", period=None), value=dict(period=-4)),
    of(contact.maximal_period, lambda: dict(nordmark=nordmark()),
       kind=dict(nordmark=each(None, 4, [nordmark()]))),
    of(contact.maximal_periods, lambda: dict(nordmark=nordmark()),
       kind=dict(nordmark=each(None, 0.5, "map"))),
    of(contact.collisions,
       lambda: dict(oscillator=eq_1(), trajectory=contact.simulate(eq_1(), periods=3), unfinished="drop"),
       kind=dict(oscillator=None, trajectory=[0.1]), value=dict(unfinished="keep")),
    of(contact.before_collision, lambda: dict(oscillator=eq_1()),
       kind=dict(oscillator=each(None, "beam")), value=dict(oscillator=told(UNDRIVEN, "drive is None"))),
    of(contact.first_collision, lambda: dict(oscillator=eq_1(), periods=64),
       kind=dict(oscillator=3, state="rest"),
       value=dict(periods=0, oscillator=told(eq_1().with_excess(-0.5), "periods is 64"))),
    of(contact.MaximalFamily.from_oscillator, lambda: dict(oscillator=eq_1(), period=3, restitution=0.1),
       name="MaximalFamily", kind=dict(oscillator=None),
       value=dict(period=0, restitution=told(-0.1, "restitution is -0.1"),
                  oscillator=each(told(UNDRIVEN, "drive is None"), told(LOADED, "load is given")))),
    of(lambda period, speed, rho, excess: (
           contact.MapFamily(nordmark(), period).orbit(speed),
           contact.MapFamily(nordmark(), period).at_rho(rho),
           contact.MapFamily(nordmark(), period).orbits(excess)),
       dict(period=4, speed=0.1, rho=0.01, excess=0.01), name="MapFamily",
       kind=dict(excess="1"), value=dict(period=0, speed=told(0.0, "speed is 0.0 [1]"), rho=NAN)),
    of(lambda speed: closed().orbit(speed), dict(speed=0.1), name="MaximalFamily.orbit",
       kind=dict(speed="fast"), value=dict(speed=each(0.0, NAN))),
    of(lambda excess: closed().orbits(excess), dict(excess=1e-3), name="MaximalFamily.orbits",
       kind=dict(excess=[1e-3]), value=dict(excess=each(-1.0, INF))),
)

ORBITS = (
    of(kick.KickFamily, lambda: dict(oscillator=eq_1(), period=5),
       kind=dict(oscillator=None),
       value=dict(period=each(0, 2.5), oscillator=each(
           told(LOADED, "load is given"), told(IDLE, "the drive does not move the tip")))),
    of(lambda speeds: kick.KickFamily(oscillator=eq_1(), period=5).fold(speeds), dict(speeds=(0.01, 0.5)),
       name="KickFamily.fold",
       kind=dict(speeds="all"), value=dict(speeds=each((0.5, 0.01), (0.0, 1.0)))),
    of(shooting.Shooting, lambda: dict(oscillator=family().oscillator, period=5),
       kind=dict(oscillator="eq_1"),
       value=dict(period=each(0, 1.5), impacts=0, oscillator=each(
           told(UNDRIVEN, "drive is None"), told(IDLE, "the drive does not move the tip")))),
    of(lambda speed: kick.KickFamily(oscillator=eq_1(), period=5).kick(speed), dict(speed=0.1),
       name="KickFamily.kick", kind=dict(speed="fast"), value=dict(speed=each(0.0, -1.0, INF))),
    of(lambda **given: family().at_speed(**given), dict(speed=0.1), name="Shooting.at_speed",
       kind=dict(speed=None, near=3), value=dict(speed=each(0.0, -0.1))),
    of(lambda **given: family().at_excess(**given),
       lambda: dict(excess=orbit().excess * 1.01, near=orbit()), name="Shooting.at_excess",
       kind=dict(near=None), value=dict(excess=each(-1.5, NAN))),
    of(continuation.follow, lambda: dict(family=family(), start=orbit(), low=0.09, high=0.11, step=0.1),
       kind=dict(family=None, start=0.1),
       value=dict(low=each(told(0.2, "low and high are 0.2 and"), told(0.0, "low and high are 0.0 and")),
                  high=told(0.095, "low and high are 0.09 and 0.095"), step=told(0.0, "step is 0.0 [1]"))),
    of(continuation.first_event, lambda: dict(family=family(), start=orbit(), lowest=-0.1),
       kind=dict(family=None, start=0.1), value=dict(lowest=-1.5)),
    of(continuation.fold_of, lambda: dict(family=family()),
       kind=dict(family=each(None, eq_1()), near=0.1)),
    of(continuation.folds_of, lambda: dict(family=family()),
       kind=dict(family=each(None, eq_1()), near=0.1)),
    of(continuation.lowest_of, lambda: dict(family=family()),
       kind=dict(family=each(None, eq_1()), near=0.1)),
    of(continuation.fold_along_frequency, lambda: dict(family=family(), frequencies=[22.2]),
       kind=dict(family=5, frequencies=["22.2"]), value=dict(frequencies=each(22.2, [NAN]))),
    of(path.follow_path, lambda: dict(path=family().oscillator.with_excess, start=orbit(), at=orbit().excess,
                                     low=-0.1, high=0.2),
       kind=dict(start=0.1), value=dict(
           path=told(None, "path is None; it must be a function"), at=told(0.3, "at is 0.3 [of p]"),
           low=NAN, high=told(-0.2, "high is -0.2 [of p]"), step=told(0.0, "step is 0.0 [1]"))),
    of(continuation.orbits_at, lambda: dict(family=family(), excess=0.01),
       kind=dict(family=None), value=dict(excess=each(-1.5, NAN))),
    of(periodic.Change, dict(gap=1.0, frequency=0.0, amplitude=0.0, law=(0.0, 0.0)),
       kind=dict(model=eq_1().model, law=each("soft", ("1", 0.0))), value=dict(law=each((1.0,), (NAN, 0.0)))),
    *(of(call, lambda: dict(orbit=orbit(), changes=[CHANGE]), name=name,
         kind=dict(orbit=each(None, 0.1), changes=each(CHANGE, 3.0, ["gap"])))
      for name, call in {"orbit_derivatives": periodic.orbit_derivatives,
                         "excess_derivatives": periodic.excess_derivatives,
                         "doubling_derivatives": unless_refused(periodic.doubling_derivatives),
                         "graze_derivatives": unless_refused(periodic.graze_derivatives)}.items()),
    of(periodic.multiplier_derivatives, lambda: dict(found=periodic.orbit_derivatives(orbit(), [CHANGE])),
       kind=dict(found=each(None, 3.0, [CHANGE]))),
    of(periodic.motion_derivatives,
       lambda: dict(oscillator=eq_1(), state=contact.State.rest(1), periods=1, changes=[CHANGE]),
       kind=dict(oscillator=None, state=[0.0], changes=each(CHANGE, [3.0])),
       value=dict(oscillator=told(UNDRIVEN, "drive is None"), state=told(at(GAP, Regime.CONTACT), "regime"))),
    of(periodic.settle, lambda: dict(strobed=system(), state=[0.0, 0.0], most_cycles=8, largest_period=2,
                                     tolerance=1e-9),
       kind=dict(strobed=each(None, eq_1())), value=dict(largest_period=0, most_cycles=-1, tolerance=-1.0)),
    *(of(call, lambda: dict(strobed=strobed(), excess=1e-3, most_cycles=8),
         kind=dict(strobed=each(None, eq_1())), value=dict(excess=-2.0, most_cycles=-1))
      for call in (periodic.born, periodic.born_period)),
    of(periodic.fold_excess, lambda: dict(strobed=system(), period=5),
       kind=dict(strobed=each(None, eq_1(), 5)), value=dict(period=2.5)),
    of(periodic.orbit_end,
       lambda: dict(strobed=strobed(), state=strobed().steady(), excess=-1e-3, most_cycles=8, first_step=1e-4,
                    relative=0.01, absolute=1e-7, lowest=-0.5),
       kind=dict(strobed=eq_1()), value=dict(first_step=0.0, absolute=0.0, relative=-1.0, lowest=-1.0)),
    of(periodic.orbit_diagram,
       lambda: dict(strobed=strobed(), excesses=[-1e-3], state=strobed().steady(), observe=strobed().tip,
                    settle_cycles=4, record_cycles=4, largest_period=2),
       kind=dict(strobed=eq_1(), excesses="1", observe=each(3, told(lambda p: "tip", "observe(points) is"))),
       value=dict(observe=told(lambda p: p, "observe(points) has shape"), settle_cycles=-1,
                  excesses=each(told([], "excesses is empty"), [[1e-3]]))),
    of(periodic.period_of, dict(points=[[0.0]] * 4, impacts=[0] * 4, largest_period=2, tolerance=1e-9),
       kind=dict(points="p"), value=dict(impacts=[0], points=each(
           [0.0], np.zeros((4, 0)), told([[0.0]] * 3, "points has 3 strobes")))),
    of(periodic.AmplitudeScan, lambda: dict(oscillator=eq_1(), most_cycles=128),
       kind=dict(oscillator=each(None, strobed())),
       value=dict(oscillator=told(UNDRIVEN, "drive is None"), most_cycles=127)),
    of(lambda **given: periodic.AmplitudeScan(oscillator=eq_1(), most_cycles=128)(**given),
       dict(frequency=22.2, excesses=[-1e-3]), name="AmplitudeScan, a column", kind=dict(excesses="all"),
       value=dict(frequency=0.0, excesses=told([1e-3, 0.0], "excesses must be"))),
    of(periodic.strobe_derivatives,
       lambda: dict(strobed=strobed().at(-0.1), state=strobed().at(-0.1).steady(), period=1),
       kind=dict(strobed=None, state=[0.0, 0.0]), value=dict(period=each(0, 1.5))),
    of(periodic.cloud,
       lambda: dict(strobed=strobed().at(-0.1), state=strobed().at(-0.1).steady(), period=1, deviation=1e-4),
       kind=dict(strobed=3.0), value=dict(deviation=each(-1e-4, NAN), memory=each(1.0, -0.1, NAN), period=0)),
    of(lyapunov.map_exponents, lambda: dict(strobed=system(), state=np.array([0.0, 0.0]), count=10, align=0),
       kind=dict(strobed=each(None, eq_1())), value=dict(count=1, align=-1)),
    of(lyapunov.orbit_exponents,
       lambda: dict(strobed=strobed().at(-0.1), state=strobed().at(-0.1).steady(), period=1),
       kind=dict(strobed=None), value=dict(period=each(0, 1.5))),
)

STEPS = each(0.0, NAN, told("1 us", "step is "))

METHODS = (
    of(integrators.CentralDifference, dict(step=1e-6), value=dict(step=STEPS)),
    of(integrators.Splitting, dict(step=1e-6), value=dict(step=STEPS, order=3)),
    of(integrators.GeneralisedAlpha, dict(step=1e-6, beta=0.25),
       value=dict(step=STEPS, beta=-1.0, gamma=0.0, alpha_m=1.0, alpha_f=NAN)),
    of(integrators.GeneralisedAlpha.hht, dict(step=1e-6, alpha=0.1),
       value=dict(step=STEPS, alpha=told(-0.1, "HHT-alpha"))),
    of(integrators.GeneralisedAlpha.with_dissipation, dict(step=1e-6, rho=0.8),
       value=dict(step=STEPS, rho=each(1.1, -0.1))),
    of(integrators.MoreauJean, dict(step=1e-6, theta=0.5), value=dict(step=STEPS, theta=2.0)),
    of(integrators.NonsmoothGeneralisedAlpha, dict(step=1e-6, rho=0.8), value=dict(step=STEPS, rho=1.5)),
    of(integrators.SampledFlight, dict(points=100),
       kind=dict(points="many"), value=dict(points=each(0, 1.5))),
)
# fmt: on
