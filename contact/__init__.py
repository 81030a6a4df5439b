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
    A spring is shaken by its base beside a stop.  Below the grazing amplitude F_g its tip stays short of the
    stop; the *excess* F/F_g - 1 counts from there.  A touch that is barely one changes the state by the
    square root of the overshoot, whatever happens between touches: the derivative of the period map is
    infinite, and just above grazing the motion jumps to a p_m orbit, one impact in m drive periods, or to
    chaos.  Lowered again, the drive finds that orbit alive down to a fold below grazing: *hysteresis*.  The
    letter "Generic behavior of grazing impact oscillators" (1996) measured this and set a two-dimensional map
    beside it.

Words
    An *impact* is one touch.  A *collision* is all the impacts of one approach, as mode 1 alone feels them:
    it leaves with -`restitution` times the speed with which it came, `delay` later; its `kick` is the jump of
    its velocity over the approach speed.  A *graze* is a touch without effect within rounding.  *Strobes* are
    the instants n/f of the drive; what happens from one to the next is a map.

From problem to answer
    `ImpactOscillator`  a ``beam.ModalModel``, a `Stop` with its law, a `HarmonicDrive`; carries no numerics
    `simulate`          its motion, every impact; the exact method of the law, or another one of
                        ``contact.integrators`` for comparison
    `StroboscopicMap`   the same from strobe to strobe; `strobed_orbits` many of them on all cores
    `collisions`        what each collision does to mode 1; `first_collision` the first above grazing
    `NonlinearMode`     one mode at finite amplitude
    `NordmarkMap`       the letter's map; its orbits (`MapFamily`), folds and `bands` in closed form
    `MaximalFamily`     the same orbits of Eq. (1) in closed form, under Newton's law
    ``contact.orbits``  orbits of any law: `settle`, `born` and `orbit_diagram` by following the motion,
                        `Shooting` and `follow` as orbits, to folds, period doublings and grazings;
                        `orbit_end` does both; ``lyapunov`` tells chaos

Laws of contact: `NewtonRestitution` (at once), `DelayedRestitution` (once, after a delay; one mode),
`LinearContact`, `HertzContact`, `HuntCrossley` (forces; followed through the contact by power series).

What cannot be followed raises one of the `ContactError` family (`UnresolvedCrossing`, `Chatter`,
`ContactTooStiff`, `NotPeriodic`, ...) with time, gap and velocity; no number comes out.  Units are SI
throughout; modes are mass-normalised (q in m kg^0.5).  Every module opens with its equations: that of motion
in ``contact.oscillator``, flights and their bounds in ``contact.flight``, the certified search for a touch in
``contact.flight.crossing``, motion in contact in ``contact.touch.linear`` and ``contact.touch.hertz``.
"""

from dataclasses import replace

from contact.collision import Collision, before_collision, collisions, first_collision
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
    UnresolvedCrossing,
)
from contact.laws import (
    ContactLaw,
    DelayedRestitution,
    HertzContact,
    HuntCrossley,
    LinearContact,
    NewtonRestitution,
)
from contact.machine.renamed import forward_modules, forwarded_call
from contact.maps.nonlinear_mode import NonlinearMode
from contact.maps.nordmark import NordmarkMap
from contact.maps.nordmark_bands import Band, band, bands
from contact.maps.nordmark_orbits import (
    MapFamily,
    MaximalOrbit,
    fold,
    maximal_orbits,
    maximal_period,
    maximal_periods,
    stable_range,
)
from contact.maps.stroboscope import StrobedMap, StrobedOrbit, StroboscopicMap, strobed_orbits
from contact.orbits.families.single_impact import MaximalFamily, SingleImpactOrbit
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import ImpactKind, Impacts, Regime, State, Trajectory

forward_modules(
    {
        "contact.nordmark": "contact.maps.nordmark",
        "contact.stroboscope": "contact.maps.stroboscope",
        "contact.nonlinear_mode": "contact.maps.nonlinear_mode",
        "contact.orbits.shooting": "contact.orbits.families.shooting",
        "contact.orbits.single_impact": "contact.orbits.families.single_impact",
        "contact.orbits.kick": "contact.orbits.families.kick",
        "contact.orbits.continuation": "contact.orbits.branches.continuation",
    }
)
StrobedNordmarkMap = forwarded_call(
    "StrobedNordmarkMap(map=nordmark, rho=rho)",
    "replace(nordmark, control=rho)",
    lambda *, map, rho=0.0: replace(map, control=rho),
)

__all__ = [
    "Band",
    "BranchEnded",
    "Chatter",
    "Collision",
    "ContactError",
    "ContactLaw",
    "ContactTooStiff",
    "DelayedRestitution",
    "Diverged",
    "HarmonicDrive",
    "HertzContact",
    "HuntCrossley",
    "ImpactKind",
    "ImpactOscillator",
    "Impacts",
    "LinearContact",
    "MapFamily",
    "MaximalFamily",
    "MaximalOrbit",
    "NewtonRestitution",
    "NonlinearMode",
    "NordmarkMap",
    "NoDerivative",
    "NotPeriodic",
    "Regime",
    "SingleImpactOrbit",
    "State",
    "StepTooLarge",
    "Stop",
    "StrobedMap",
    "StrobedOrbit",
    "StroboscopicMap",
    "Trajectory",
    "UnresolvedCrossing",
    "band",
    "bands",
    "before_collision",
    "collisions",
    "first_collision",
    "fold",
    "maximal_orbits",
    "maximal_period",
    "maximal_periods",
    "simulate",
    "stable_range",
    "strobed_orbits",
]
