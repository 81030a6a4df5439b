"""Whether a linear spring is enough at the amplitude of the gap, for each reading of "U shaped".

Claim: a folded U with a tight bend softens so much at 11 mm that it loses the letter's periods; a single
leaf, legs side by side or a wide bend keep them.

    f = f_0 (1 + kappa (A/L)^2)   of the spring (``beam.backbone_coefficient``), L its straight run
    effective period              of small deviations from the motion that grazes (``contact.NonlinearMode``),
                                  beside that of the spring with finite rotations (``beam.harmonic_balance``)
    born period                   of Eq. (1) with the cubic stiffness and inertia of kappa, excess counted
                                  from the drive at which this motion grazes

Readings of "U shaped": `folded` (both ends clamped, the ball on the bend), `side_by_side` (two legs in the
plane of the sheet), `channel` and `plain`, which bend as one leaf. Sheets are as thick as the free period
asks. Where the frame's effective period is known and differs by more than 0.005 ms, the cubic stiffness is
the one that gives the frame's.

A touch of the nonlinear mode is located to 1e-14 of the gap within a step of a Taylor series; what the cubic
terms leave out is the difference to the frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from scipy.optimize import newton

from beam import Backbone, FiniteRotation, backbone_coefficient, periodic_motion
from contact import NonlinearMode
from contact.orbits import born_period
from studies.physics.calibration import calibrate_thickness
from studies.shell.scene import Scene, harmonic, nonlinear_mode_at, periods_of, spring_of
from studies.shell.study import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Answer = TypeVar("Answer")

STRAIGHT = ("side_by_side", "channel", "plain")
"""Readings that bend as one leaf; in the plane a channel is a plain strip."""
RADII = (4e-3, 5.5e-3, 7.5e-3, 10e-3, 15e-3, 20e-3, 25e-3, 30e-3, 40e-3)
GAPS, BALLS = (4e-3, 7e-3, 15e-3, 20e-3), (0.0, 4e-3, 8e-3)
"""Bend radii, gaps [m] and masses of ball and mount [kg] beside the scene's own."""

EXCESSES = (2.5e-4, 1e-3, 1e-2)
"""At which the born period is asked: the letter's stability, its scale, and well above."""

CLOSE = 5e-6
"""Effective periods of mode and frame that agree to this are the same [s]."""

COARSE = {"spring.elements_per_leg": 24, "spring.elements_on_arc": 24}
STRAIGHT_ELEMENTS, ARC_ELEMENTS = 12, 24
"""Of the frame on each piece: its effective period is then good to 1e-6 s."""


@dataclass(frozen=True, kw_only=True)
class Survival:
    """One spring; lists go with the scene's drive frequencies. Born period 0: not settled; nothing: no motion
    that grazes, or one whose deviations do not turn, as next to a turning point of the response.

    `shift` is kappa (gap/L)^2. L = `length_m` is the first straight run; with legs side by side it is a leg
    and the straight length equivalent to the bend. `survive` counts the letter's periods that are born both
    at 2.5e-4 and at 1e-3. `frame`: whether the frame was solved. Its effective period is used if it differs
    by more than 0.005 ms.
    """

    reading: str
    bend_radius_m: float
    gap_m: float
    tip_mass_kg: float
    length_m: float
    kappa: float
    kappa_elastic: float
    kappa_inertial: float
    shift: float
    effective_period_s: tuple[float | None, ...]
    born_period: tuple[int | None, ...]
    born_2p5e_4: tuple[int | None, ...]
    born_1e_2: tuple[int | None, ...]
    survive: int
    frame: bool


@dataclass(frozen=True, kw_only=True)
class EffectivePeriod:
    """The effective period of small deviations by the mode with cubic terms and by the frame."""

    reading: str
    bend_radius_m: float
    gap_m: float
    frequency_hz: float
    mode_s: float | None
    frame_s: float | None


def reading_of(scene: Scene, reading: str, radius: float, ball: float) -> Scene:
    """The scene with its spring read so, the sheet as thick as the free period asks."""
    kind = {"folded": "folded_u", "side_by_side": "flat_u"}.get(reading, "cantilever")
    changed = scene.replace(
        {"spring.kind": kind, "spring.bend_radius_m": radius, "tip.mass_kg": ball, **COARSE}
    )
    return calibrate_thickness(changed, scene.single_mode.free_period_s)


def matched(mode: NonlinearMode, effective: float) -> NonlinearMode:
    """The mode with the cubic stiffness that gives an effective period [s]."""

    def off(stiffness: float) -> float:
        return replace(mode, stiffness=stiffness).effective_period - effective

    guess = off(mode.stiffness) / (0.75 * mode.free_period * mode.gap**2)
    return replace(mode, stiffness=float(newton(off, mode.stiffness, x1=mode.stiffness + guess)))


def tried(question: Callable[[], Answer]) -> Answer | None:
    """The answer, or None where there is none."""
    try:
        return question()
    except (RuntimeError, ArithmeticError, np.linalg.LinAlgError):
        return None


def frame_period(scene: Scene, model: FiniteRotation, frequency: float) -> float:
    """The effective period of the spring with finite rotations, driven to the gap [s].

    Its coarse mesh is a little too stiff: time is measured in free periods.
    """
    keys = scene.single_mode
    free = math.hypot(2.0 * math.pi / keys.free_period_s, 0.5 * keys.decay_rate_per_s)
    faster = model.first_mode[0] / free
    motion = periodic_motion(
        model, scene.stop.gap_m, frequency=frequency * faster, decay_rate=keys.decay_rate_per_s * faster
    )
    return motion.effective_period * faster


@dataclass(frozen=True)
class Spring:
    """One spring of the map, by its reading, bend radius [m] and ball [kg].

    With the scene's own ball its frame is solved at the scene's own gap.
    """

    scene: Scene
    reading: str
    radius: float
    ball: float

    def __call__(self, gaps: Sequence[float]) -> tuple[list[Survival], list[EffectivePeriod]]:
        """Its rows at each gap [m]."""
        drawn = reading_of(self.scene, self.reading, self.radius, self.ball)
        backbone = backbone_coefficient(spring_of(drawn))
        rows, frames = list[Survival](), list[EffectivePeriod]()
        for gap in gaps:
            scene = drawn.replace({"stop.gap_m": gap})
            modes = [nonlinear_mode_at(scene, f, backbone) for f in scene.drive.frequencies_hz]
            turning = [partial(getattr, mode, "effective_period") for mode in modes]
            effective: list[float | None] = [tried(one) for one in turning]
            known = gap == self.scene.stop.gap_m and self.ball == self.scene.tip.mass_kg
            if known:
                spring = spring_of(drawn)
                bent = spring.centreline.curvatures != 0.0
                model = FiniteRotation.of(spring, np.where(bent, ARC_ELEMENTS, STRAIGHT_ELEMENTS).tolist())
                exact = [tried(partial(frame_period, scene, model, f)) for f in scene.drive.frequencies_hz]
                pairs = list(zip(modes, effective, exact, strict=True))
                frames += [
                    EffectivePeriod(
                        reading=self.reading,
                        bend_radius_m=self.radius,
                        gap_m=gap,
                        frequency_hz=mode.frequency,
                        mode_s=mine,
                        frame_s=other,
                    )
                    for mode, mine, other in pairs
                ]
                for i, (mode, mine, other) in enumerate(pairs):
                    if mine and other and abs(other - mine) > CLOSE:
                        fitted = tried(partial(matched, mode, other))
                        modes[i], effective[i] = (fitted, other) if fitted else (mode, mine)
            rows.append(self._row(scene, backbone, modes, effective, known))
        return rows, frames

    def _row(
        self,
        scene: Scene,
        backbone: Backbone,
        modes: Sequence[NonlinearMode],
        effective: Sequence[float | None],
        frame: bool,
    ) -> Survival:
        cycles = scene.scan.settle_cycles
        low, middle, high = (
            tuple(tried(partial(born_period, mode, excess, most_cycles=cycles)) for mode in modes)
            for excess in EXCESSES
        )
        letter = periods_of(scene)
        wanted = [letter.get(mode.frequency) for mode in modes]
        return Survival(
            reading=self.reading,
            bend_radius_m=self.radius,
            gap_m=scene.stop.gap_m,
            tip_mass_kg=self.ball,
            length_m=backbone.length,
            kappa=backbone.kappa,
            kappa_elastic=backbone.elastic,
            kappa_inertial=backbone.inertial,
            shift=backbone.kappa * (scene.stop.gap_m / backbone.length) ** 2,
            effective_period_s=tuple(effective),
            born_period=middle,
            born_2p5e_4=low,
            born_1e_2=high,
            survive=sum(a == b == c for a, b, c in zip(wanted, low, middle, strict=True)),
            frame=frame,
        )


def finite_amplitude(scene: Scene, run: Run) -> list[Survival]:
    """The springs of the map, stored and drawn."""
    keys = harmonic(scene).spring
    spring_of(scene)  # refuses measured modes, which no reading gives a shape
    radii = sorted({*(RADII[2::5] if run.quick else RADII), keys.bend_radius_m})
    balls = sorted({*(() if run.quick else BALLS), scene.tip.mass_kg})
    gaps = sorted({*(GAPS[:1] if run.quick else GAPS), scene.stop.gap_m})
    springs = [Spring(scene, "folded", radius, ball) for radius, ball in product(radii, balls)]
    leaves = [name for name in STRAIGHT if name != "channel"]
    springs += [Spring(scene, name, keys.bend_radius_m, ball) for name, ball in product(leaves, balls)]
    found = run.map(partial(Spring.__call__, gaps=gaps), springs, "springs")
    rows, frames = [row for part, _ in found for row in part], [row for _, part in found for row in part]
    rows += [replace(row, reading="channel") for row in rows if row.reading == "plain"]
    shown = (
        "reading",
        "bend_radius_m",
        "gap_m",
        "tip_mass_kg",
        "length_m",
        "kappa",
        "born_period",
        "survive",
    )
    run.table("springs", rows, "Springs by reading, radius, gap and ball; born period at 1e-3.", show=shown)
    run.table("frame", frames, "Effective period of deviations: mode with cubic terms, frame.", show=())
    run.figure(
        "finite_amplitude",
        draw(scene, rows),
        "How many of the letter's periods are born at 2.5e-4 "
        "and at 1e-3: of the folded strip with the scene's ball over bend radius and gap; of all "
        "springs against the shift of the frequency at the gap.",
    )
    return rows


def draw(scene: Scene, rows: Sequence[Survival]) -> Figure:
    """Periods that survive: of the folded strip over bend radius and gap, of all against the shift."""
    from studies.shell import plotting

    with plotting.house_style():
        figure, (chart, axis) = plotting.new_figure(1, 2, width=plotting.PAGE)
        for row in rows:
            if row.reading == "folded" and row.tip_mass_kg == scene.tip.mass_kg:
                place = 1e3 * row.bend_radius_m, 1e3 * row.gap_m
                chart.scatter(*place, s=120, color=plotting.tint(plotting.BLUE, row.survive / 6))
                chart.annotate(str(row.survive), place, ha="center", va="center")
        chart.set_xscale("log")
        ticks = [1e3 * radius for radius in (RADII[0], 7.5e-3, 15e-3, 25e-3, RADII[-1])]
        chart.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        chart.set_xticks([], minor=True)
        chart.margins(0.08, 0.12)
        plotting.label(chart.xaxis, "bend radius", "mm")
        plotting.label(chart.yaxis, "gap", "mm")
        for n, reading in enumerate(("folded", *STRAIGHT)):
            own = [row for row in rows if row.reading == reading]
            words = reading.replace("_", " ")
            shift = [abs(row.shift) for row in own]
            axis.plot(shift, [row.survive for row in own], **plotting.points(n), label=words)
        axis.set_xscale("log")
        plotting.label(axis.xaxis, "|kappa| (gap/L)^2", "1")
        plotting.label(axis.yaxis, "letter's periods born at both")
        plotting.legend_below(figure, [axis], 4)
    return figure
