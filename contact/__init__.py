"""Impacts of a modal spring on a stop: exact flights, certified impacts, contact laws, maps and collisions.

    from beam import single_mode
    from contact import HarmonicDrive, ImpactOscillator, NewtonRestitution, Stop, simulate

    oscillator = ImpactOscillator(
        model=single_mode(free_period=40.80e-3, decay_rate=3.56),
        stop=Stop(gap=0.0107, law=NewtonRestitution(local_restitution=0.1)),
        drive=HarmonicDrive(frequency=22.2),
    ).with_excess(1e-3)
    trajectory = simulate(oscillator, periods=1000)
    trajectory.strobe_impacts[-10:]          # one impact in every fifth period

The subject
    The base of a spring is shaken beside a stop.  Below the grazing amplitude F_g the tip does not reach the
    stop; the *excess* is F/F_g - 1.  A slow impact changes the state by the square root of the overshoot,
    under any contact law, so that the period map has an infinite derivative.  Just above grazing the motion
    jumps to chaos or to a p_m orbit, with one impact in m drive periods.  When the drive is lowered again,
    this orbit persists down to a fold below grazing: *hysteresis*.  The letter "Generic behavior of grazing
    impact oscillators" (1996) measured this and compared it with a two-dimensional map.

Words
    An *impact* is one touch.  A *collision* is all the impacts of one approach, as mode 1 feels them: mode 1
    leaves with -`restitution` times its approach speed after the time `delay`, and its `kick` is the jump of
    its velocity over the approach speed.  A *graze* is a touch whose effect is below rounding error.
    *Strobes* are the instants n/f of the drive; a stroboscopic map takes the state from one to the next.  A
    *stretch* goes from one strobe to the next.  A *period* is a time in seconds; an orbit p_m repeats after
    m of them.  A *run* is a simulated motion under way, as kernels keep it.

The files: the problem and its answer
    ``drive``           base motion, `HarmonicDrive`
    ``laws``            contact laws: `NewtonRestitution` (at once), `LinearContact` (a force)
    ``hertz``           forces of a ball: `HertzContact`, `HuntCrossley`; the laws `PowerContact` and
                        `DelayedRestitution` (one mode) stand in ``touch``
    ``speed_table``     functions of the approach speed, such as a restitution, as tables
    ``restitution``     `damping_ratio` of a restitution; `restitution_from_bounces`
    ``stop``            `Stop`: a gap, a law, and where it lies
    ``plausible``       warnings of sizes that no spring has
    ``steady_response`` the motion without contact, and the drive amplitude at which it grazes
    ``oscillator``      `ImpactOscillator`: a ``beam.ModalModel``, stops and a drive; the equation of motion
    ``impacts``         `Impacts`: every touch of a motion
    ``state``           `State`, and the kinds of contact as numbers
    ``trajectory``      `Trajectory`; ``tables`` and ``plots`` write and draw it
    ``simulation``      `simulate`: a motion with every impact, exact or by a method with a time step
    ``virtual_motion``  the motion of mode 1 as if there were no stop
    ``collision_numbers``
                        `Collision`: the effect of one collision on mode 1
    ``collision``       `collisions` of a trajectory; `first_collision`
    ``errors``          the `ContactError` family, for motions that cannot be followed
    ``warm_up``         a program that compiles all kernels once: ``python -m contact.warm_up``

The folders, from the machine to the orbits
    ``machine``         compiled kernels and where their machine code is kept
    ``flight``          motion between touches in closed form, and the certified search for the next touch
    ``touch``           motion in contact, one file a law; the record of touches
    ``engine``          the loop over flights and touches, and what a run keeps of them
    ``integrators``     the exact method and the methods with a time step
    ``one_mode``        Eq. (1) of the letter, one mode under Newton's law, fast
    ``sensitivity``     derivatives of a motion with respect to its start and its parameters
    ``maps``            `StroboscopicMap`; `NonlinearMode`, one mode at finite amplitude; `NordmarkMap`, the
                        letter's map, with its orbits (`MapFamily`), folds and `frequency_band` in
                        closed form
    ``orbits``          periodic orbits: `MaximalFamily` in closed form under Newton's law, `Shooting` under
                        any law; `settle` and `orbit_diagram` by following the motion; `follow` to folds,
                        period doublings and grazings; `orbit_end`, where an orbit is lost; Lyapunov exponents

A motion that cannot be followed raises a `ContactError` (`UnresolvedCrossing`, `Chatter`, `ContactTooStiff`,
`NotPeriodic`, ...) with time, gap and velocity, and returns no number.  Units are SI throughout; modes are
mass-normalised (q in m kg^0.5).  A module with physics opens with its equations.
"""

from contact.collision import before_collision, collisions, first_collision
from contact.collision_numbers import Collision
from contact.drive import HarmonicDrive
from contact.errors import (
    BranchEnded,
    Chatter,
    ContactError,
    ContactTooStiff,
    Diverged,
    NoDerivative,
    NotPeriodic,
    StepTooLarge,
    TouchedAtOnce,
    UnresolvedCrossing,
)
from contact.hertz import HertzContact, HuntCrossley
from contact.impacts import Impacts
from contact.laws import ContactLaw, LinearContact, NewtonRestitution
from contact.maps.nonlinear_mode import NonlinearMode
from contact.maps.nordmark import NordmarkMap
from contact.maps.nordmark_bands import Band, frequency_band
from contact.maps.nordmark_orbits import MapFamily, MaximalOrbit, coexisting_m, maximal_m
from contact.maps.stroboscope import StrobedMap, StrobedOrbit, StroboscopicMap
from contact.orbits.families.single_impact import MaximalFamily, SingleImpactOrbit
from contact.oscillator import ImpactOscillator
from contact.restitution import MeasuredRestitution, damping_ratio, restitution_from_bounces
from contact.simulation import simulate
from contact.state import ImpactKind, Regime, State
from contact.stop import Stop
from contact.touch.delayed import DelayedRestitution
from contact.touch.power_law import PowerContact
from contact.trajectory import Trajectory

__version__ = "0.9.0"

__all__ = sorted(
    name for name, one in globals().items() if getattr(one, "__module__", "").startswith("contact.")
)
"""All classes and functions imported above, so that each name stands once."""
