"""What one approach of the tip to the plate does to the single-mode motion: restitution, delay and kick.

Claim (letter 1996): a collision of the spring with its many modes is, for the single mode of Eq. (1), an
impact with "energy loss and time delay"; the restitution is "estimated to be tau ~ 0.1", and the loss is put
down to energy given to the higher modes.

Computed: the first collision of the steady driven motion at an excess above grazing, and from it
(contact.collision)

    restitution tau, delay, kick = -(jump of the mode-1 tip velocity)/v, shift = jump of its displacement,
    tau^2 = (1 - kick)^2 + 2 a shift / v^2,   delay = (v/a)(1 + tau - kick)         to leading order in v,

v the approach speed, v/a the time to the top of the arc beyond the gap, a = (2 pi f)^2 gap.  Varied, one at a
time: excess, number of modes, tip mass (free period and drive amplitude at grazing kept), stiffness and
material of the contact, damping of the higher modes, loss in the contact; and tip mass together with loss and
with stiffness, in search of the letter's tau.

What comes out for the folded spring with its tape:

- tau is |1 - kick| with a floor near sqrt(contact time * a/v).  The floor is the time that the contact takes,
  not loss: at the excess of Fig. 4 (0.013) a ceramic ball on steel leaves tau = 0.22 to 0.23 for any loss in
  the contact, each at its own tip mass.  tau = 0.1 asks for thirtyfold stiffness or for an excess of 0.19; or
  for a settled orbit, where what is left of the ringing shifts the touch and tau may come out anywhere below.
- Half of the kick is gone at an excess near 7e-5 under Hertz's law, at 2e-5 with the linear contact of the
  scene: below the amplitude stability of the experiment, 2.5e-4, where 76 to 82 % of the kick are left.
- 18 modes are enough at the tip mass of the scene, 24 at a tenth of the leaf, 30 for a bare cantilever under
  Hertz's law.  A bare tip has tau = 0.7 and a delay longer than v/a.  Under Newton's law the count of its
  impacts grows with the modes without end; tau and delay hardly change, but to 1e-3 they do not stand still.
- That the kick on a hard stop is 2 M phi_1^2 is a limit far off: the bend, a quarter of the mass of the ball,
  goes along with it.  Real contacts have a kick of 0.99, a stop of 1e7 times the tip stiffness 0.94, and the
  ball by itself has 0.81.

Run time: about a minute; --quick about ten seconds.  Command: python -m studies.effective_impact.
Outputs: summary.json (rows, answers), collisions.csv, and a figure as png and pdf for each of speed, mass and
search, and without --quick modes, stiffness, damping and loss.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from studies.instruments.command_line import Request, run_study
from studies.instruments.contact_calibration import Targets
from studies.instruments.effective_impact.answers import (
    clusters,
    fade,
    hard_stop,
    stands_still,
    worst_of_closed_forms,
)
from studies.instruments.effective_impact.approaches import measure_all, own_contact, select
from studies.instruments.effective_impact.curves import SCENE_MASS, all_curves
from studies.instruments.effective_impact.figures import draw_all
from studies.instruments.effective_impact.grid import Grid
from studies.instruments.effective_impact.restitution import floor_over_mass, local_loss
from studies.instruments.effective_impact.specimen import Specimen
from studies.instruments.effective_impact.words import closing_lines, table
from studies.instruments.quantities import SceneError
from studies.instruments.scene import Scene
from studies.instruments.tip_mass_family import bare_cantilever, with_mass_ratio
from studies.published import AMPLITUDE_STABILITY_M, DRIVE_AMPLITUDE_M, RESTITUTION, TIME_TRACE_EXCESS

FINE_MESH = {"spring.elements_per_leg": 120, "spring.elements_on_arc": 60}
"""Twice the default: the mode curve goes to 60 modes, which the default mesh does not resolve."""

COARSE_MESH = {"spring.elements_per_leg": 30, "spring.elements_on_arc": 16}
"""Half the default or less, for --quick: 20 modes are good to 1e-3."""

LIGHT = 0.1
"""Tip mass over leaf of the light tip in the mode curve."""


def calibrated_frequency(scene: Scene) -> float:
    """The drive frequency of the scene nearest to that at which mass and gap were fitted [Hz]."""
    return min(scene.drive.frequencies_hz, key=lambda f: abs(f - Targets.frequency_hz))


def refuse_unfit(scene: Scene) -> None:
    """SceneError for a scene whose tip mass cannot be varied or that has no drive."""
    if scene.drive.kind != "harmonic":
        raise SceneError(f"drive.kind is {scene.drive.kind}; an approach to the plate needs a harmonic drive")
    if scene.spring.kind == "modal_data":
        raise SceneError(
            "spring.kind modal_data has no tip mass to vary: this study needs a spring that is drawn"
        )


def specimens(
    scene: Scene, frequency: float, grid: Grid, workers: int, full: bool
) -> tuple[Specimen, list[Specimen], dict[str, Specimen]]:
    """The spring as it is, the family of tip masses, and three springs with many modes."""
    meshed = scene
    if not (scene.spring.elements_per_leg or scene.spring.elements_on_arc):
        meshed = scene.replace(FINE_MESH) if full else scene.replace(COARSE_MESH)
        scene = scene if full else meshed

    def of_mass(ratio: float) -> Specimen:
        return Specimen.of(with_mass_ratio(scene, ratio, frequency), frequency, grid.modes)

    def with_many(name: str) -> Specimen:
        if name == "scene":
            return Specimen.of(meshed, frequency, grid.check_modes)
        if name == "light tip":
            return Specimen.of(with_mass_ratio(meshed, LIGHT, frequency), frequency, grid.check_modes)
        return Specimen.of(bare_cantilever(meshed, frequency), frequency, grid.check_modes)

    names = ("scene", "light tip", "bare cantilever")
    with ThreadPoolExecutor(max_workers=workers) as pool:
        fine, masses = pool.map(with_many, names), pool.map(of_mass, grid.mass_ratios)
        return Specimen.of(scene, frequency, grid.modes), list(masses), dict(zip(names, fine, strict=True))


def answers_from(rows: Sequence[dict[str, Any]], scene: Scene, grid: Grid) -> dict[str, Any]:
    """The questions of the docstring, answered from the rows."""
    resolution = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M
    lines = {
        curve: dict.fromkeys(r["series"] for r in rows if r["curve"] == curve) for curve in ("speed", "modes")
    }
    own = [r for r in own_contact(rows, "modes") if r["modes"] == grid.modes]
    reference = (
        own[0] if own else dict.fromkeys(("restitution", "kick", "delay_s", "arc_s", "contact_s"), math.nan)
    )
    names = ("restitution", "kick", "delay_s", "arc_s", "contact_s")
    return {
        "reference": {name: reference[name] for name in names}
        | {"excess": TIME_TRACE_EXCESS, "delay_over_arc": reference["delay_s"] / reference["arc_s"]},
        "local_loss": local_loss(rows, RESTITUTION),
        "smallest_restitution": floor_over_mass(
            select(rows, "mass", f"excess {TIME_TRACE_EXCESS:g}"), RESTITUTION
        ),
        "clusters": clusters(rows),
        "modes": {name: stands_still(select(rows, "modes", name), grid.modes) for name in lines["modes"]},
        "fade": {
            name: fade(select(rows, "speed", name), resolution, scene.scan.born_excess)
            for name in lines["speed"]
        },
        "hard_stop": hard_stop(select(rows, "stiffness", SCENE_MASS)),
        "closed_forms": worst_of_closed_forms(rows),
        "amplitude_resolution": resolution,
    }


def with_ball_limit(rows: list[dict[str, Any]], cells: Sequence[Any]) -> None:
    """Add 2 M phi_1^2, the kick of a ball by itself on a hard stop, to every row."""
    for row, cell in zip(rows, cells, strict=True):
        row["ball_limit"] = 2.0 * row["tip_mass"] * float(cell.oscillator.model.phi[0]) ** 2


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store, draw and answer."""
    began = time.perf_counter()
    refuse_unfit(scene)
    grid = Grid.quick() if request.quick else Grid.full()
    frequency = calibrated_frequency(scene)
    own, masses, fine = specimens(scene, frequency, grid, request.workers, not request.quick)
    cells = all_curves(own, masses, fine, grid)
    with request.progress("collisions", total=len(cells)) as progress:
        rows = measure_all(cells, request.workers, progress.advance)
    with_ball_limit(rows, cells)
    request.record.write_table("collisions", {name: [row[name] for row in rows] for name in rows[0]})
    for name, figure in draw_all(rows, quick=request.quick).items():
        request.record.write_figure(figure, name)
    answers = answers_from(rows, scene, grid)
    failures = [row["failure"] for row in rows if row["failure"]]
    for line in [*table(rows), *failures, *closing_lines(answers)]:
        print(line, flush=True)
    return {
        "rows": rows,
        "answers": answers,
        "frequency_hz": frequency,
        "closing": closing_lines(answers),
        "failures": failures,
        "failed_cells": len(failures),
        "wall_s": time.perf_counter() - began,
    }


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "effective_impact",
        "Restitution, delay and kick of one approach to the plate, against all that they may depend on.",
        run, argv,
    )


if __name__ == "__main__":
    raise SystemExit(main())
