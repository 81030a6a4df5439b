"""Periodic orbits of a strobed motion, one idea a file.

`family`: what all families of orbits offer; `single_impact`: one collision every m drive periods, under
Newton's law in closed form; `kick`: one collision of any law, by linear algebra; `shooting`: any law and any
number of touches, with exact tangents; `curve`: a curve of orbits, point beside point; `events` on it;
`branch`: a curve followed both ways; `continuation`: branches over the amplitude; `path`: branches along any
path p -> oscillator; `settling`: on what a motion settles; `scan`: orbit
diagrams, the state carried along; `ends`: where an orbit ends when the drive is lowered, by a scan and by its
fold; `amplitude_scan`: the compiled column of a chart; `lyapunov`: exponents; `derivatives`,
`event_derivatives`, `motion_derivatives`: how orbits, their folds, doublings and grazings, and simulated
motions change with the numbers of the oscillator, a `Change` each; `clouds`: strobe points under noise of the
drive.
"""

from contact.orbits.branches.continuation import (
    Branch,
    first_event,
    fold_along_frequency,
    fold_of,
    folds_of,
    follow,
    lowest_of,
)
from contact.orbits.branches.event_derivatives import (
    doubling_derivatives,
    graze_derivatives,
    multiplier_derivatives,
)
from contact.orbits.branches.events import Event
from contact.orbits.branches.orbit_derivatives import OrbitDerivatives, excess_derivatives, orbit_derivatives
from contact.orbits.branches.path import follow_path
from contact.orbits.families.family import Family, Orbit
from contact.orbits.families.kick import KickFamily
from contact.orbits.families.shooting import PeriodicOrbit, Shooting
from contact.orbits.families.single_impact import Kick, MaximalFamily, SingleImpactOrbit
from contact.orbits.observation.amplitude_scan import AmplitudeScan, ScannedColumn
from contact.orbits.observation.covariance import cloud, strobe_derivatives
from contact.orbits.observation.ends import OrbitEnd, fold_excess, orbit_end
from contact.orbits.observation.lyapunov import Exponents, map_exponents, orbit_exponents
from contact.orbits.observation.repetition import period_of
from contact.orbits.observation.scan import OrbitDiagram, orbit_diagram
from contact.orbits.observation.settling import Settled, born, born_period, settle
from contact.sensitivity.change import Change
from contact.sensitivity.motion import MotionDerivatives, motion_derivatives

__all__ = [
    "AmplitudeScan",
    "Branch",
    "Change",
    "Event",
    "Exponents",
    "Family",
    "Kick",
    "KickFamily",
    "MaximalFamily",
    "MotionDerivatives",
    "Orbit",
    "OrbitDerivatives",
    "OrbitDiagram",
    "OrbitEnd",
    "PeriodicOrbit",
    "ScannedColumn",
    "Settled",
    "Shooting",
    "SingleImpactOrbit",
    "born",
    "born_period",
    "cloud",
    "doubling_derivatives",
    "excess_derivatives",
    "first_event",
    "fold_along_frequency",
    "fold_excess",
    "fold_of",
    "folds_of",
    "follow",
    "follow_path",
    "graze_derivatives",
    "lowest_of",
    "map_exponents",
    "motion_derivatives",
    "multiplier_derivatives",
    "orbit_derivatives",
    "orbit_diagram",
    "orbit_end",
    "orbit_exponents",
    "period_of",
    "settle",
    "strobe_derivatives",
]
