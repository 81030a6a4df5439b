"""Periodic orbits of a strobed motion.

`families`      orbits of one period in one description: closed forms, kicks, and shooting with exact tangents
`branches`      branches of orbits over the amplitude or along any path p -> oscillator, their folds, period
                doublings, tori and grazings, and derivatives of all these with respect to parameters
`shooting`      `Shooting`, the family under any law, with its folds and all its orbits at one amplitude
`observation`   motions followed in time: settling, orbit diagrams, the loss of an orbit when the drive is
                lowered, a compiled column of a chart, Lyapunov exponents, covariances under noise

A parameter is a `Change`, a direction in which the numbers of the oscillator change.
"""

from contact.orbits.branches.branch import Branch
from contact.orbits.branches.continuation import first_event, follow
from contact.orbits.branches.events import Event
from contact.orbits.branches.folds import fold_along_frequency, fold_of
from contact.orbits.branches.orbit_derivatives import OrbitDerivatives, excess_derivatives, orbit_derivatives
from contact.orbits.branches.path import follow_path
from contact.orbits.families.kick import KickFamily
from contact.orbits.families.protocol import Family, Orbit
from contact.orbits.families.single_impact import Kick, MaximalFamily, SingleImpactOrbit
from contact.orbits.observation.amplitude_scan import AmplitudeScan
from contact.orbits.observation.covariance import strobe_covariance, strobe_derivatives
from contact.orbits.observation.ends import OrbitEnd, fold_excess, orbit_end
from contact.orbits.observation.lyapunov import Exponents, map_exponents, orbit_exponents
from contact.orbits.observation.scan import OrbitDiagram, orbit_diagram
from contact.orbits.observation.settling import Settled, onset_m, onset_orbit, settle
from contact.orbits.shooting import PeriodicOrbit, Shooting
from contact.sensitivity.change import Change
from contact.sensitivity.derivatives import MotionDerivatives, motion_derivatives

__all__ = sorted(
    name for name, one in globals().items() if getattr(one, "__module__", "").startswith("contact.")
)
"""All classes and functions imported above, so that each name stands once."""
