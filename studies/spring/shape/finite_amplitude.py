"""Whether a linear spring is enough at the amplitude of the gap, for each reading of "U shaped".

    f = f_0 (1 + kappa (A/L)^2)   of the spring (``beam.backbone_coefficient``), L its straight run
    effective period              of small deviations from the motion that grazes (``contact.NonlinearMode``),
                                  beside that of the spring with finite rotations (``beam.periodic_motion``)
    born period                   of Eq. (1) with the cubic stiffness and inertia of kappa, excess counted
                                  from the drive at which this motion grazes

Readings: `folded` (both ends clamped, the ball on the bend), `side_by_side` (two legs in the plane of the
sheet) and `plain`, a single leaf; in the plane a channel is a plain strip. Sheets are as thick as the free
period requires. With the scene's own ball and gap the frame with finite rotations is solved as well: where
its effective period differs by more than 0.005 ms, the cubic stiffness is the one that gives the frame's.

A touch of the nonlinear mode is located to 1e-14 of the gap within a step of a Taylor series; what the cubic
terms leave out is the difference to the frame.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Annotated, ParamSpec, TypeVar

import numpy as np
from scipy.optimize import newton

from beam import FiniteRotation, backbone_coefficient, periodic_motion
from contact import NonlinearMode
from contact.orbits import onset_m
from studies.letter import AMPLITUDE_STABILITY
from studies.physics.calibration import calibrate_thickness
from studies.shell.scene import Scene, harmonic, nonlinear_mode_at, periods_of, spring_of
from studies.spring.shape.shapes import TITLES, Reading

P = ParamSpec("P")
Answer = TypeVar("Answer")
Key = tuple[Reading, float, float]  # a spring of the map: its reading, bend radius [m] and ball [kg]

LEAVES: tuple[Reading, ...] = ("side_by_side", "plain")
"""Readings that bend as one leaf, whatever the radius of the bend."""
RADII = (4e-3, 5.5e-3, 7.5e-3, 10e-3, 15e-3, 20e-3, 25e-3, 30e-3, 40e-3)
GAPS, BALLS = (4e-3, 7e-3, 15e-3, 20e-3), (0.0, 4e-3, 8e-3)
"""Bend radii, gaps [m] and masses of ball and mount [kg] beside the scene's own."""

EXCESSES = (AMPLITUDE_STABILITY, 1e-3)
"""At which the born period is computed: the letter's stability, and its scale."""

CLOSE = 5e-6  # effective periods of mode and frame that agree to this are the same [s]

COARSE = {"spring.elements_per_leg": 24, "spring.elements_on_arc": 24}
STRAIGHT_ELEMENTS, ARC_ELEMENTS = 12, 24
"""Of the frame on each piece: its effective period is then good to 1e-6 s."""


@dataclass(frozen=True, kw_only=True)
class Survival:
    """One spring; L is the first straight run, with legs side by side a leg and what the bend adds to it."""

    reading: Annotated[str, "shape"]
    bend_radius_m: Annotated[float, "bend radius [m]"]
    gap_m: Annotated[float, "gap [m]"]
    tip_mass_kg: Annotated[float, "ball and mount [kg]"]
    length_m: Annotated[float, "length L [m]"]
    kappa: Annotated[float, "κ; the free frequency changes by κ (A/L)² at an amplitude A"]
    effective_period_s: Annotated[
        Mapping[str, float | None],
        "effective period [s]; none where no small deviation returns after a period",
    ]
    born_period: Annotated[Mapping[str, int | None], "period at the excess 0.001; 0: not settled"]
    survive: Annotated[int | None, "periods as the letter saw them, at the excesses 0.00025 and 0.001"]


def reading_of(scene: Scene, reading: str, radius: float, ball: float) -> Scene:
    """The scene with its spring read so, the sheet as thick as the free period requires."""
    kind = {"folded": "folded_u", "side_by_side": "flat_u"}.get(reading, "cantilever")
    own = {"spring.kind": kind, "spring.bend_radius_m": radius, "tip.mass_kg": ball}
    return calibrate_thickness(scene.replace(own | COARSE), scene.single_mode.free_period_s)


def matched(mode: NonlinearMode, effective: float) -> NonlinearMode:
    """The mode with the cubic stiffness that gives an effective period [s]."""

    def off(stiffness: float) -> float:
        return replace(mode, stiffness=stiffness).effective_period - effective

    guess = off(mode.stiffness) / (0.75 * mode.free_period * mode.gap**2)
    return replace(mode, stiffness=float(newton(off, mode.stiffness, x1=mode.stiffness + guess)))


def tried(question: Callable[P, Answer], *arguments: P.args, **options: P.kwargs) -> Answer | None:
    """The answer, or None where there is none."""
    try:
        return question(*arguments, **options)
    except (RuntimeError, ArithmeticError, np.linalg.LinAlgError):
        return None


def frame_period(scene: Scene, model: FiniteRotation, frequency: float) -> float:
    """The effective period of the spring with finite rotations, driven to the gap [s].

    Its coarse mesh is a little too stiff: time is measured in free periods.
    """
    keys = scene.single_mode
    free = math.hypot(2.0 * math.pi / keys.free_period_s, 0.5 * keys.decay_rate_per_s)
    faster = model.first_mode[0] / free
    here, rate = frequency * faster, keys.decay_rate_per_s * faster
    motion = periodic_motion(model, scene.stop.gap_m, frequency=here, decay_rate=rate)
    return motion.effective_period * faster


def with_frame(scene: Scene, modes: Sequence[NonlinearMode]) -> list[NonlinearMode]:
    """The modes, with the frame's effective period where theirs differs."""
    spring, found = spring_of(scene), []
    bent = spring.centreline.curvatures != 0.0
    model = FiniteRotation.of(spring, np.where(bent, ARC_ELEMENTS, STRAIGHT_ELEMENTS).tolist())
    for mode in modes:
        mine, frame = effective(mode), tried(frame_period, scene, model, mode.frequency)
        differs = mine and frame and abs(frame - mine) > CLOSE
        found.append((tried(matched, mode, frame) if frame and differs else None) or mode)
    return found


def effective(mode: NonlinearMode) -> float | None:
    """Its effective period [s]."""
    return tried(getattr, mode, "effective_period")


def survivals(scene: Scene, gaps: Sequence[float], spring: Key) -> list[Survival]:
    """The rows of a spring at each gap [m]."""
    reading, radius, ball = spring
    drawn, rows = reading_of(scene, reading, radius, ball), []
    backbone, letter = backbone_coefficient(spring_of(drawn)), periods_of(scene)
    for gap in gaps:
        here = drawn.replace({"stop.gap_m": gap})
        modes = [nonlinear_mode_at(here, f, backbone) for f in scene.drive.frequencies_hz]
        if gap == scene.stop.gap_m and ball == scene.tip.mass_kg:
            modes = with_frame(here, modes)
        cycles = scene.scan.settle_cycles
        low, born = ([tried(onset_m, mode, e, most_cycles=cycles) for mode in modes] for e in EXCESSES)
        wanted = [letter.get(mode.frequency) for mode in modes]
        places = [f"at_{mode.frequency:g}_Hz" for mode in modes]
        rows.append(
            Survival(
                reading=TITLES[reading],
                bend_radius_m=radius,
                gap_m=gap,
                tip_mass_kg=ball,
                length_m=backbone.length,
                kappa=backbone.kappa,
                effective_period_s=dict(zip(places, map(effective, modes), strict=True)),
                born_period=dict(zip(places, born, strict=True)),
                survive=sum(a == b == c for a, b, c in zip(wanted, low, born, strict=True) if a)
                if any(wanted)
                else None,
            )
        )
    return rows


def springs_of(scene: Scene, quick: bool) -> tuple[list[Key], list[float]]:
    """The springs of the map, and the gaps [m] at which each is looked at."""
    keys = harmonic(scene).spring
    spring_of(scene)  # refuses measured modes, which no reading gives a shape
    radii = sorted({*(RADII[2::5] if quick else RADII), keys.bend_radius_m})
    balls = sorted({*(() if quick else BALLS), scene.tip.mass_kg})
    found: list[Key] = list(product(["folded"], radii, balls))
    found += product(LEAVES, [keys.bend_radius_m], balls)
    return found, sorted({*(GAPS[:1] if quick else GAPS), scene.stop.gap_m})
