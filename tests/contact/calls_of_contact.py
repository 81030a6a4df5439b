"""Public calls of `contact`: right arguments and wrong values; how it is written: calls_of_beam."""

import dataclasses
from functools import cache

import numpy as np
from calls_of_beam import INF, NAN, each, fields_of, of, says
from cases_of_calls import GAP, HERTZ, NEWTON

import beam
import contact
from contact import Regime, integrators
from contact import orbits as periodic

EQ_1 = NEWTON.oscillator.with_excess(1e-3)


@cache
def nordmark() -> contact.NordmarkMap:
    return contact.NordmarkMap(alpha=0.5, gamma=0.8, restitution=0.1)


@cache
def bent() -> contact.NonlinearMode:
    numbers = dict(free_period=40.8e-3, decay_rate=3.56, stiffness=-100.0, inertia=90.0)
    return contact.NonlinearMode(**numbers, gap=GAP, restitution=0.1, frequency=22.2, excess=0.01)


@cache
def closed() -> contact.MaximalFamily:
    return contact.MaximalFamily.from_oscillator(EQ_1, m=5)


def closed_forms(oscillator: contact.ImpactOscillator) -> None:
    """The orbits of Newton's law; TypeError for another one."""
    family = contact.MaximalFamily.from_oscillator(oscillator, m=5)
    fold = family.fold()
    assert fold is not None and family.orbits(0.01)
    assert family.orbit(0.1).state().time == family.orbit(0.1).phase and family.excess(1e-3) < 1.0
    assert fold.monodromy().shape == (2 * oscillator.n_modes, 2 * oscillator.n_modes)


def at(displacement: float, regime: Regime = Regime.OUTSIDE, time: float = 0.0) -> contact.State:
    """A resting state of Eq. (1), the tip at `displacement` [m]."""
    q = displacement / float(EQ_1.model.phi[0])
    return contact.State(displacement=[q], velocity=[0.0], regime=regime, time=time)


OFF_STROBE = says(at(0.0, time=1e-3), "time of the state is 0.001 s")
THREE_MODES = says(contact.State.rest(3), "displacement of the state has 3 modes")
LOADED = says(dataclasses.replace(EQ_1, load=np.array([1.0])), "load is given")
TWO = dataclasses.replace(EQ_1, stops=(EQ_1.stop, dataclasses.replace(EQ_1.stop, side=-1)))
TWO_STOPS = says(TWO, "stops has 2 entries")
UNDRIVEN = says(dataclasses.replace(EQ_1, drive=None), "drive is None")
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
MAP = contact.StroboscopicMap
TWENTY = np.arange(20.0)
WRONG_REGIMES = ((0.0, Regime.SUSTAINED), (GAP, Regime.CONTACT), (GAP, Regime.INSIDE))
METHODS_USED = (
    integrators.SampledFlight(points=64),
    integrators.NonsmoothGeneralisedAlpha(step=1e-5, rho=0.9),
    integrators.Splitting(step=1e-5),
    integrators.CentralDifference(step=1e-5),
    integrators.MoreauJean(step=1e-5),
    integrators.GeneralisedAlpha(step=1e-5),
)

# fmt: off
CONTACT = (
    of(lambda parent: type("Own", (parent,), {}), dict(parent=contact.ContactLaw), name="final classes",
       kind=dict(parent=each(*(says(one, f"is a subclass of {one.__name__};") for one in FINAL)))),
    of(contact.HarmonicDrive, dict(frequency=22.2, amplitude=1e-3),
       kind=dict(frequency="22.2 Hz"), value=dict(frequency=0.0, amplitude=-1e-3)),
    of(contact.Stop, dict(gap=0.0107, law=contact.NewtonRestitution(local_restitution=0.1)),
       kind=dict(gap="10.7 mm", law=each(None, 0.1, "newton", contact.HertzContact), at=each(3, ("a", 1))),
       value=dict(gap=-0.01, side=each(0, 2, "up"), at=("tip", "tip"))),
    of(contact.NewtonRestitution, dict(local_restitution=0.1),
       kind=dict(local_restitution=each("0.1", None, [[0, 1], [0.1]],
                                        says(lambda v: "soft", "m/s is 'soft'"))),
       value=dict(local_restitution=each(1.1, 1.0000001, -1e-12, NAN, [0.1], [[1], [0.1]],
                                         [[2, 1], [0.1, 0.2]], [[-1, 1], [0.1, 0.2]],
                                         says([[0, 1e-320], [0, 1]], "1e-320"),
                                         says([[0, 1], [0.1, NAN]], "local_restitution holds nan"),
                                         says([[0, 1], [0.1, 1.2]], "1 m/s is 1.2"),
                                         says([[0, 1e-3], [0, 1e308]], "0.001 m/s is 1e+308"),
                                         says(lambda v: 1.2 - v, "1e-05 m/s is 1.19999"),
                                         says(lambda v: NAN, "m/s is nan")),
                  speeds=each((1.0, 1.0), (0.0, 1.0)))),
    of(contact.DelayedRestitution, dict(restitution=0.1, delay=1e-4),
       kind=dict(restitution=each("soft", None, says(lambda v: "soft", "m/s is 'soft'")),
                 delay=each("late", None, [1e-4])),
       value=dict(restitution=each(2.0, 1.0000001, -0.01, -1e-12, NAN,
                                   says(lambda v: 1.2 - v, "restitution runs from"),
                                   says(lambda v: 0.5 if v < 1 else NAN, "restitution")),
                  delay=each(-1e-9, NAN, INF, says(lambda v: 1e-4 - v, "delay"),
                             says(lambda v: INF, "delay")),
                  speeds=each(says(3.0, "speeds has shape ()"), (1.0,), (1.0, 1.0), (0.0, 1.0), (1.0, NAN)))),
    of(contact.LinearContact, dict(stiffness=1e6, damping=0.0),
       kind=dict(stiffness=None, damping=None),
       value=dict(stiffness=each(0, 0.0, -1.0), damping=each(-1.0, -1e-300))),
    of(contact.LinearContact.with_restitution, dict(stiffness=1e6, restitution=0.5, mass=0.02),
       kind=dict(stiffness=None, restitution=each("half", None), mass="light"),
       value=dict(stiffness=each(0, -1.0), restitution=each(0.0, -1e-12, 1.0000001),
                  mass=each(0.0, -0.02, NAN))),
    of(contact.PowerContact, dict(stiffness=8e9, exponent=1.5, damping=0.0),
       kind=dict(stiffness=None, exponent="Hertz", damping=None),
       value=dict(stiffness=each(0, -1.0), exponent=each(0.999, 3.25, 1.51, 1.3333, 10 / 9, NAN),
                  damping=each(-1.0, -1e-300))),
    of(contact.PowerContact, dict(stiffness=8e9, exponent=1.25, damping=1.0), name="PowerContact, damped",
       value=dict(exponent=each(1.125, 1.2, 1.2500001))),
    of(contact.PowerContact.with_restitution, dict(stiffness=8e9, exponent=1.5, restitution=0.5, mass=0.02),
       kind=dict(stiffness=None, exponent=None, restitution=each("half", None), mass="light"),
       value=dict(stiffness=each(0, -1.0), exponent=each(0.5, 1.51, 1.125), mass=each(0.0, -0.02, NAN),
                  restitution=each(0.0, -1e-12, 1.0000001))),
    of(contact.damping_ratio, dict(restitution=0.5), kind=dict(restitution=None),
       value=dict(restitution=each(0.0, -0.1, 1.0000001, NAN))),
    of(contact.restitution_from_bounces, dict(times=[0.0, 1.0, 1.5, 1.76]),
       kind=dict(times=each("now", None)),
       value=dict(times=each([0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 1.0, 0.5], [[0.0, 1.0, 1.5]],
                             [0.0, 1.0, NAN]))),
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
    of(contact.ImpactOscillator, lambda: fields_of(EQ_1),
       kind=dict(model=None, stop=0.0107, drive=22.2, load=["a"]),
       value=dict(stop=says(dataclasses.replace(HERTZ.oscillator.stop, gap=0.0), "gap is 0.0 m"),
                  load=[1.0, 2.0])),
    of(contact.ImpactOscillator, lambda: dict(model=EQ_1.model, stops=TWO.stops),
       name="ImpactOscillator, stops", kind=dict(stops=each(EQ_1.stop, [0.1])),
       value=dict(stop=says(EQ_1.stop, "stop and stops are both given"),
                  stops=each(says([], "at least one Stop"), says(None, "stop is missing"),
                             says(2 * [EQ_1.stop], "lie at one place"),
                             says([dataclasses.replace(EQ_1.stop, gap=0.0, side=x) for x in (1, -1)],
                                  "from both sides"),
                             says([dataclasses.replace(EQ_1.stop, at="nose")], "at is 'nose'")))),
    of(lambda excess: EQ_1.with_excess(excess), dict(excess=1e-3), name="ImpactOscillator.with_excess",
       kind=dict(excess="0.1 %"), value=dict(excess=each(-1.0, NAN))),
    of(lambda amplitude: EQ_1.with_amplitude(amplitude), dict(amplitude=1e-3),
       name="ImpactOscillator.with_amplitude",
       kind=dict(amplitude=None), value=dict(amplitude=each(-1e-3, INF))),
    of(EQ_1.tip, dict(values=[[0.0], [NAN]]), name="ImpactOscillator.tip",
       value=dict(values=each("tip", contact.State.rest(1), [0.0, 1.0], 0.0, [[0.0], [0.0, 1.0]]))),
    of(contact.State, START | dict(time=0.0, regime=0, wait=0.0, rebound=0.0),
       kind=dict(displacement="rest"), value=dict(displacement=each([], [NAN]),
                  velocity=each([0.0, 1.0], says([[0.0]], "velocity of the state")),
                  regime=each(7, -1, 5, 17), time=NAN, stop=each(-1, 0.5))),
    of(contact.State.rest, dict(n_modes=2),
       kind=dict(n_modes="two"), value=dict(n_modes=each(0, 1.5))),
    of(contact.simulate, lambda c: dict(oscillator=c.driven, state=c.state, periods=5,
                                        times=np.linspace(0.0, 0.2, 50)), over="starts",
       kind=dict(oscillator=None, state=[0.0, 0.0], times="now", method=3),
       value=dict(periods=each(0, -2, 1.5, says(None, "duration and periods")),
                  times=says([0.02, 0.01], "times is [0.02, 0.01] s"), method="magic",
                  state=each(THREE_MODES, says(at(1.0), "m behind the stop"),
                             *(says(at(x, regime), "regime") for x, regime in WRONG_REGIMES)))),
    *(of(contact.simulate, lambda c, method=method: dict(
             oscillator=c.driven, state=c.fast, periods=2, method=method),
         name=f"simulate, {type(method).__name__}", over="motion") for method in METHODS_USED),
    of(contact.simulate, lambda: dict(oscillator=EQ_1, duration=1.0), name="simulate, for a duration",
       kind=dict(duration="1 s"),
       value=dict(duration=each(0.0, -1.0, NAN, says(1e12, "duration is 1e+12 s")),
                  periods=says(3, "duration and periods"),
                  times=each(says([0.2, NAN], "times holds nan s"), says([[0.2]], "times has shape"),
                             says([0.5, 1.1], "times run from"), says([-0.1, 0.5], "times run from")))),
    of(contact.StroboscopicMap, lambda: dict(oscillator=EQ_1), kind=dict(oscillator=3),
       value=dict(oscillator=TWO_STOPS)),
    of(MAP.at, lambda c: dict(self=c.strobed, excess=0.1), over="motion", value=dict(excess=-2.0)),
    of(MAP.steady, lambda c: dict(self=c.strobed), over="motion"),
    of(MAP.orbit, lambda c: dict(self=c.strobed, state=c.state, count=20), over="starts",
       value=dict(count=each(-5, 2.5), state=OFF_STROBE)),
    of(MAP.orbit, lambda c: dict(self=c.strobed, state=c.fast, count=20, factors=1 + 0.2 * np.sin(TWENTY)),
       name="StroboscopicMap.orbit, factors", over="motion", kind=dict(factors=each("1", ["a", "b"])),
       value=dict(factors=each([1.0], [1.0] * 19 + [0.0], [NAN] * 20, 1.0))),
    of(MAP.tip, lambda c: dict(self=c.strobed, points=c.strobed.orbit(c.state, 3).points), over="motion",
       kind=dict(points="p"), value=dict(points=each([0.0, 0.0], np.zeros((2, 0)), [[0.0, 0.0, 0.0]]))),
    of(MAP.readout, lambda c: dict(self=c.strobed, points=np.zeros((1, 2 * c.driven.n_modes)), name="laser"),
       over="motion", value=dict(name="no such point")),
    of(MAP.coordinates, lambda c: dict(self=c.strobed, state=c.state), over="starts",
       kind=dict(state=[0.0, 0.0]), value=dict(state=THREE_MODES)),
    of(MAP.jacobians, lambda c: dict(self=c.strobed, state=c.state, count=5), over="starts",
       kind=dict(state=[0.0, 0.0]), value=dict(state=each(THREE_MODES, OFF_STROBE))),
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
    of(contact.NordmarkMap.from_oscillator, lambda: dict(oscillator=EQ_1),
       kind=dict(oscillator=each(3, says(HERTZ.oscillator, "law of the stop is HertzContact"))),
       value=dict(oscillator=each(UNDRIVEN, TWO_STOPS))),
    of(lambda state, rho, count: nordmark().iterate(state, rho, count),
       dict(state=[0.0, 0.0], rho=0.01, count=3), name="NordmarkMap.iterate",
       kind=dict(rho="0.01"), value=dict(state=each([0.0], [NAN, 0.0]), count=-1)),
    of(lambda state, count, factors: nordmark().orbit(state, count, factors=factors),
       dict(state=[0.0, 0.0], count=3, factors=[1.0, 1.1, 1.2]), name="NordmarkMap.orbit",
       value=dict(state=each([0.0], [NAN, 0.0]), count=-1, factors=each([1.1], [1.0, 1.0, 0.0]))),
    of(contact.frequency_band, BAND | dict(m=4),
       kind=dict(m="p4"), value=dict(m=1, free_period=-1.0, whole_turns=-1, y_line=3)),
    of(contact.maximal_m, lambda: dict(nordmark=nordmark()),
       kind=dict(nordmark=each(None, 4, [nordmark()]))),
    of(contact.coexisting_m, lambda: dict(nordmark=nordmark()),
       kind=dict(nordmark=each(None, 0.5, "map"))),
    of(contact.collisions,
       lambda c: dict(trajectory=contact.simulate(c.driven, c.state, periods=5), unfinished="drop"),
       over="starts", kind=dict(trajectory=each(None, [0.1])), value=dict(unfinished="keep")),
    of(contact.before_collision, lambda: dict(oscillator=EQ_1),
       kind=dict(oscillator=each(None, "beam")), value=dict(oscillator=each(UNDRIVEN, TWO_STOPS))),
    of(contact.first_collision, lambda c: dict(oscillator=c.driven, state=c.state, periods=5), over="starts",
       kind=dict(oscillator=3, state="rest"),
       value=dict(periods=0, oscillator=says(EQ_1.with_excess(-0.5), "periods is 5"))),
    of(contact.first_collision, lambda c: dict(oscillator=c.oscillator), name="first_collision, at rest",
       over="motion"),
    of(closed_forms, lambda c: dict(oscillator=c.oscillator), name="MaximalFamily.from_oscillator",
       over="family"),
    of(contact.MaximalFamily.from_oscillator, lambda: dict(oscillator=EQ_1, m=3, local_restitution=0.1),
       name="MaximalFamily.from_oscillator, refused",
       kind=dict(oscillator=None),
       value=dict(m=0, local_restitution=says(-0.1, "restitution is -0.1"),
                  oscillator=each(UNDRIVEN, LOADED, TWO_STOPS))),
    of(lambda m, speed, rho, excess: (
           contact.MapFamily(nordmark(), m).orbit(speed),
           contact.MapFamily(nordmark(), m).at_rho(rho),
           contact.MapFamily(nordmark(), m).orbits(excess)),
       dict(m=4, speed=0.1, rho=0.01, excess=0.01), name="MapFamily",
       kind=dict(excess="1"), value=dict(m=0, speed=says(0.0, "speed is 0.0 [1]"), rho=NAN)),
    of(lambda speed: closed().orbit(speed), dict(speed=0.1), name="MaximalFamily.orbit",
       kind=dict(speed="fast"), value=dict(speed=each(0.0, NAN))),
    of(lambda excess: closed().orbits(excess), dict(excess=1e-3), name="MaximalFamily.orbits",
       kind=dict(excess=[1e-3]), value=dict(excess=each(-1.0, INF))),
)

STEPS = each(0.0, NAN, says("1 us", "step is "))

METHODS = (
    of(integrators.CentralDifference, dict(step=1e-6), value=dict(step=STEPS)),
    of(integrators.Splitting, dict(step=1e-6), value=dict(step=STEPS, order=3)),
    of(integrators.GeneralisedAlpha, dict(step=1e-6, beta=0.25),
       value=dict(step=STEPS, beta=-1.0, gamma=0.0, alpha_m=1.0, alpha_f=NAN)),
    of(integrators.GeneralisedAlpha.hht, dict(step=1e-6, alpha=0.1),
       value=dict(step=STEPS, alpha=says(-0.1, "HHT-alpha"))),
    of(integrators.GeneralisedAlpha.with_dissipation, dict(step=1e-6, rho=0.8),
       value=dict(step=STEPS, rho=each(1.1, -0.1))),
    of(integrators.MoreauJean, dict(step=1e-6, theta=0.5), value=dict(step=STEPS, theta=2.0)),
    of(integrators.NonsmoothGeneralisedAlpha, dict(step=1e-6, rho=0.8), value=dict(step=STEPS, rho=1.5)),
    of(integrators.SampledFlight, dict(points=100),
       kind=dict(points="many"), value=dict(points=each(0, 1.5))),
)
# fmt: on
