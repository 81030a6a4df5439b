"""What the six transitions owe to the letter's errors, to its noise and to what it leaves open.

Claims (letter 1996): T = 40.80 +- 0.02 ms; the drive is stable to 0.5 um of 2 mm (2.5e-4); "the highest
observed period (p10) is at the limit of our experimental resolution and stability".

Computed: born period and fold at each of the six frequencies after each change of one parameter, in
Nordmark's map, Eq. (1) and the beam; and whether the strobe points of p_m are still told apart when the
amplitude is noisy, for m = 3 ... 16 in Eq. (1), and for the beam at three of the letter's frequencies.

Run time: about a minute; --quick some ten seconds.  Command: python -m studies.sensitivity.  Outputs:
summary.json, sensitivity.csv, noise.csv, the figures fold_against_parameter, strobe_points, noise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from contact.stroboscope import StroboscopicMap
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import Request, run_study
from studies.instruments.oscillators import beam_of
from studies.instruments.scene import Scene
from studies.instruments.sensitivity.amplitude_noise import SKIPPED, STROBES, noise_at, noisy
from studies.instruments.sensitivity.answers import answers_of, number, sentences
from studies.instruments.sensitivity.changed_folds import row_at
from studies.instruments.sensitivity.noise_figures import draw_noise, draw_points
from studies.instruments.sensitivity.scene_changes import Change, changed, changes_of
from studies.instruments.sensitivity.strobe_clouds import clouds, since_impact
from studies.instruments.sensitivity.tornado_figure import draw_tornado
from studies.instruments.spring_of_scene import model_of

PERIOD_RANGE = range(3, 17)


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; the transitions need a harmonic drive")
    if scene.spring.kind == "modal_data":
        raise ValueError("spring.kind is modal_data; this study varies the dimensions of a spring")
    frequencies = sorted(scene.drive.frequencies_hz)
    todo = changes_of(scene, request.quick)
    model = model_of(scene)
    strobes = 400 + SKIPPED if request.quick else STROBES
    range_of_m = range(8, 12) if request.quick else PERIOD_RANGE
    failures: list[str] = []
    with ThreadPoolExecutor(max_workers=request.workers) as pool:
        noise_futures = [pool.submit(noise_at, scene, m, strobes) for m in range_of_m]
        first = list(pool.map(lambda f: row_at(scene, model, f, None, None), frequencies))
        rows = [row for row, _ in first]

        def of_change(change: Change) -> list[dict[str, Any]]:
            try:
                there, modes = changed(scene, change)
            except ValueError as error:
                failures.append(f"{change.parameter} {change.text}: {error}")
                return []
            return [
                row_at(there, modes, f, change, base)[0]
                for f, (_, base) in zip(frequencies, first, strict=True)
            ]

        with request.progress("changes", total=len(todo)) as progress:
            for found in pool.map(of_change, todo):
                rows += found
                progress.advance()
        noise = [future.result() for future in noise_futures]
        answers = answers_of(scene, model, rows, noise, pool)
        shown = [f for f in (20.90, 22.60, 23.40) if f in frequencies] or frequencies[:3]
        panels, stored = [], {}
        for f in shown:
            strobed = StroboscopicMap(oscillator=beam_of(scene, f, model))
            m = next(row["m"] for row in rows if row["frequency_hz"] == f and row["parameter"] == "none")
            stem = f"beam_{f:.2f}_hz".replace(".", "p")
            panel: dict[str, Any] = {"frequency_hz": f, "m": m, "stem": stem}
            for kind in ("jitter", "drift"):
                points, impacts = noisy(strobed, lambda p, s=strobed: s.readout(p, "readout"), kind, strobes)  # type: ignore[misc]
                stored[f"{stem}_{kind}"], stored[f"{stem}_{kind}_phase"] = points, since_impact(impacts)
                panel[kind] = clouds(points, impacts, m) if m > 1 else clouds(points, impacts, 2)
            panels.append(panel)
    request.record.write_arrays("strobe_points", **stored)
    names = (
        "frequency_hz",
        "parameter",
        "change",
        "born_map",
        "born_single_mode",
        "born_beam",
        "fold_map",
        "fold_single_mode",
        "fold_beam",
    )
    request.record.write_table(
        "sensitivity", {n: [math.nan if row[n] is None else row[n] for row in rows] for n in names}
    )
    request.record.write_table("noise", _noise_columns(noise))
    request.record.write_figure(draw_tornado(rows), "fold_against_parameter")
    request.record.write_figure(draw_points(stored, panels), "strobe_points")
    request.record.write_figure(draw_noise(noise), "noise")
    answers["words"] = sentences(scene, answers, rows)
    print(
        f"{'f (Hz)':>7} {'parameter':>24} {'change':>9} {'born: map, Eq. (1), beam':>26}   "
        "fold: map, Eq. (1), beam"
    )
    for row in rows:
        periods = ", ".join(f"p{row[f'born_{n}']}" for n in ("map", "single_mode", "beam"))
        folds = ", ".join(number(row[f"fold_{n}"], "+.3e") for n in ("map", "single_mode", "beam"))
        print(f"{row['frequency_hz']:7.2f} {row['parameter']:>24} {row['change']:>9} {periods:>26}   {folds}")
    for line in [*failures, *answers["words"]]:
        print(line, flush=True)
    return {
        "rows": rows,
        "answers": answers,
        "noise": noise,
        "beam_in_noise": panels,
        "failures": failures,
        "failed_cells": len(failures),
    }


def _noise_columns(noise: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """The table of the noise."""
    found: dict[str, list[Any]] = {
        name: [math.nan if row[name] is None else row[name] for row in noise]
        for name in ("m", "frequency_hz", "band_hz", "born", "fold", "upper_end")
    }
    for kind in ("jitter", "drift"):
        for name in ("regular", "spread", "separation", "told_apart"):
            found[f"{kind}_{name}"] = [
                math.nan if row[kind][name] is None else row[kind][name] for row in noise
            ]
    return found


NEEDS = (Need(quantity="fold", tolerance=0.05, everywhere=True, mesh=False),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "sensitivity",
        "The six transitions under the letter's errors, noise and open assumptions.",
        run,
        argv,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
