"""Springs that the words allow, each calibrated to the letter's numbers: what decides between them.

Thickness, tape, gap and ball are fitted as by `studies.calibration`, so that all have the free period, the
decay rate, the drive amplitude at grazing and the kick of the scene. What is left differs: how far the spring
is from linear at its gap (``beam.backbone_coefficient``), against how much the bands of the p_m allow, and
torsion.
"""

from __future__ import annotations

from dataclasses import dataclass

from studies.calibration import Targets, calibrate_all, collision_at
from studies.scene import Scene, backbone_of, period_shifts, single_mode_of
from studies.spring_shape.rows import reading_row
from studies.spring_shape.shapes import Reading, brought_to, shape_of

KINDS = {"side_by_side": "flat_u", "folded": "folded_u", "plain": "cantilever"}
"""Reading -> spring.kind."""

FOLDS = (0.0075, 0.02, 0.03, 0.04)
"""Radii of the bend of folded strips [m]."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """One spring. `moved`: what the amplitude of the gap changes in the period that small deviations feel, at
    the drive frequency where this comes nearest to a band's edge or goes farthest beyond; `margin`: the
    distance of that edge, both relative.
    `turn_of_twist`: theta of the ball in the first twist mode [kg^(-1/2) m^(-1)]."""

    reading: str
    bend_radius_m: float
    thickness_m: float
    tape_loss_factor: float
    tip_mass_kg: float
    gap_m: float
    kick: float
    restitution: float
    delay_s: float
    kappa: float
    moved: float
    margin: float
    ratio_twist: float
    turn_of_twist: float


@dataclass(frozen=True)
class Drawn:
    """A reading with the radius of its bend [m], and how far the ball sits off the line of symmetry [m]."""

    reading: Reading
    radius: float
    off_line: float

    def __str__(self) -> str:
        return f"{self.reading}, bend {1e3 * self.radius:g} mm"

    def calibrated(self, scene: Scene) -> Candidate:
        """The spring, fitted; SceneError where no ball gives the kick."""
        drawn = scene.replace({"spring.kind": KINDS[self.reading], "spring.bend_radius_m": self.radius})
        targets = Targets.of(scene)
        fitted = calibrate_all(drawn, targets)
        collision = collision_at(fitted, targets.frequency_hz, targets.excess)
        bare = brought_to(shape_of(fitted, self.reading), float(single_mode_of(fitted).omega[0]))
        twist = reading_row(bare, self.off_line)
        moved, margin = max(period_shifts(fitted).values(), key=lambda pair: abs(pair[0]) / pair[1])
        return Candidate(
            reading=self.reading, bend_radius_m=self.radius, thickness_m=fitted.spring.thickness_m,
            tape_loss_factor=fitted.spring.tape_loss_factor, tip_mass_kg=fitted.tip.mass_kg,
            gap_m=fitted.stop.gap_m, kick=collision.kick, restitution=collision.restitution,
            delay_s=collision.delay,
            kappa=backbone_of(fitted).kappa, moved=moved, margin=margin, ratio_twist=twist.ratio_twist,
            turn_of_twist=twist.turn_of_twist,
        )  # fmt: skip


def drawn_springs(scene: Scene, off_line: float, quick: bool) -> list[Drawn]:
    """Legs side by side and the plain strip with the bend of the scene, folds of several radii; the first in
    the small form."""
    own = scene.spring.bend_radius_m
    springs = [Drawn("side_by_side", own, off_line), *(Drawn("folded", radius, off_line) for radius in FOLDS)]
    return springs[:1] if quick else [*springs, Drawn("plain", own, off_line)]
