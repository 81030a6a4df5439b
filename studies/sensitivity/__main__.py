"""What the six transitions owe to the letter's errors, to its noise and to what it leaves open.

Claims (letter 1996): T = 40.80 +- 0.02 ms; the drive is stable to 0.5 um of 2 mm (2.5e-4); "the highest
observed period (p10) is at the limit of our experimental resolution and stability".

Computed: born period at excess 1e-3 and fold F_m/F_g - 1 at each of the six frequencies after each change of
one parameter, in Nordmark's map, Eq. (1) and the beam; and whether the strobe points of p_m are still told
apart when the amplitude is noisy (studies.sensitivity.noise), for m = 3 ... 16 in Eq. (1), and for the beam
at three of the letter's frequencies.

What comes out: nothing within the errors gives p10 at grazing at 23.40 Hz. Its band edge in the map is
f T = 20/21, which asks for T <= 40.70 ms; p10 is what is born from an excess of 4e-3 on, so that a first step
past grazing of 9 um of 2 mm skips p11. The closest strobe points of p_m run into one another from
m = 10 on with jitter, from m = 7 on with drift; the hysteresis sinks below the noise from m = 9 on.

Run:     python -m studies.sensitivity [--periods M M] [--strobes N]     a minute; --quick ten seconds
Writes:  sensitivity.csv (a row a frequency and change), noise.csv (a row a period and kind of noise),
         last_frequency.csv, strobe_points.npz, and the figures fold_against_parameter, noise, strobe_points
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Annotated

from beam import ModalModel
from contact import StroboscopicMap
from studies.letter import AMPLITUDE_STABILITY
from studies.run import Run, study
from studies.scene import Scene, SceneError, beam_at, corresponding, harmonic, model_of
from studies.sensitivity.changes import HIGHEST, NAMES, PARAMETERS, Row, at_last, changes_of, row_at, rows_of
from studies.sensitivity.noise import KINDS, Clouds, Points, beam_in_noise, single_mode_in_noise

__all__ = ["sensitivity"]

IN_THE_SMALL_FORM = 4
"""So many parameters, the first ones, are changed there."""

SHOWN_HZ = (20.90, 22.60, 23.40)
"""Where the beam's strobe points are drawn, of the letter's frequencies."""

IRREGULAR = 0.9
"""Part of the intervals between impacts that are m periods long below which noise has broken the orbit."""


@study(needs={"fold": 0.05}, quick={"periods": (8, 11), "strobes": 400})
def sensitivity(
    scene: Scene,
    run: Run,
    *,
    periods: Annotated[tuple[int, int], "first and last m of Eq. (1) in noise"] = (3, 16),
    strobes: Annotated[int, "noisy drive periods followed"] = 800,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    if harmonic(scene).spring.kind == "modal_data":
        raise SceneError("spring.kind is modal_data; this study varies the dimensions of a spring")
    if not 2 <= periods[0] <= periods[1]:
        raise ValueError(f"periods are {periods}; they must be two whole numbers from 2 up, in their order")
    model = model_of(scene)
    rows = varied(run, scene, model)
    base = [row for row in rows if row.parameter == "none"]
    ms = range(periods[0], periods[1] + 1)
    in_noise = run.map(partial(single_mode_in_noise, scene, strobes), ms, "noise")
    single = [clouds for found in in_noise for clouds in found]
    here = {corresponding(scene, f) for f in SHOWN_HZ}
    shown = [row for row in base if row.frequency_hz in here] or base[:3]
    beam, arrays = list[Clouds](), dict[str, Points]()
    for row in run.track(shown, "beam in noise"):
        strobed = StroboscopicMap(oscillator=beam_at(scene, row.frequency_hz, model))
        found, points = beam_in_noise(strobed, row.m, strobes)
        beam += found
        arrays |= {f"{stem_of(row.frequency_hz)}_{kind}": value for kind, value in points.items()}
    run.arrays("strobe_points", **arrays)
    run.table("noise", single + beam, "Strobe points in amplitude noise: merged where told_apart is below 1.")
    describe = partial(at_last, scene, model, base[-1])
    last = run.map(describe, ("single_mode", "single_mode_short_period", "beam"), "last frequency")
    run.table("last_frequency", last, "The orbit born at the last frequency, and where p10 is born instead.")
    from studies.sensitivity import figure  # matplotlib is slow to import

    run.figure("fold_against_parameter", figure.draw_tornado(rows), figure.TORNADO)
    run.figure("noise", figure.draw_noise(single), figure.NOISE)
    run.figure("strobe_points", figure.draw_points(beam, arrays), figure.POINTS)
    first = firsts(single)
    judge(run, first["first_period_with_merged_points"])
    return {
        "rows": rows,
        "noise": single + beam,
        "last_frequency": last,
        **first,
        "frequencies_with_hysteresis_below_noise_hz": [
            row.frequency_hz for row in base if row.m > 1 and abs(row.fold_beam or 0.0) < AMPLITUDE_STABILITY
        ],
        "changes_that_give_the_letters_last_period": [
            f"{row.parameter} {row.change}"
            for row in rows
            if row.frequency_hz == base[-1].frequency_hz and HIGHEST in [row.born(name) for name in NAMES]
        ],
        "free_period_for_it_at_grazing_s": 2.0 * HIGHEST / ((2.0 * HIGHEST + 1.0) * base[-1].frequency_hz),
    }


def varied(run: Run, scene: Scene, model: ModalModel) -> list[Row]:
    """The rows without a change and after each."""
    base = run.map(partial(row_at, scene, model), sorted(scene.drive.frequencies_hz), "frequencies")
    rows, changes = [*base], list(changes_of(scene, PARAMETERS[: IN_THE_SMALL_FORM if run.quick else None]))
    after = run.map(partial(rows_of, scene, base), changes, "changes")
    for change, found in zip(changes, after, strict=True):
        if isinstance(found, str):
            run.failed(f"{change.parameter.name} {change.text}", found)
        else:
            rows += found
    columns = [name for name in Row.__dataclass_fields__ if name not in ("sign", "m")]
    run.table("sensitivity", rows, "Born period and fold after each change of one parameter.", show=columns)
    return rows


def stem_of(frequency: float) -> str:
    """The name of the beam's points at a frequency [Hz]."""
    return f"beam_{frequency:.2f}_hz".replace(".", "p")


def firsts(single: Sequence[Clouds]) -> dict[str, dict[str, int | None]]:
    """By kind of noise the first period whose closest strobe points run into one another, whose order of
    impacts is lost, and whose hysteresis is smaller than the noise."""
    says: dict[str, Callable[[Clouds], bool]] = {
        "first_period_with_merged_points": lambda row: (row.told_apart or 0.0) < 1.0,
        "first_period_that_noise_breaks": lambda row: row.regular < IRREGULAR,
        "first_period_with_hysteresis_below_noise": lambda row: abs(row.fold or 1.0) < AMPLITUDE_STABILITY,
    }
    by_kind = {kind: [row for row in single if row.noise == kind] for kind in KINDS}
    return {
        name: {kind: next((row.m for row in rows if holds(row)), None) for kind, rows in by_kind.items()}
        for name, holds in says.items()
    }


def judge(run: Run, merged: Mapping[str, int | None]) -> None:
    """Verdict on the highest period."""
    first = merged["jitter"]
    run.verdict(
        "last_period",
        "agrees" if first is not None and 0 <= first - HIGHEST <= 1 else "in part",
        found=", ".join(f"{f'p{m}' if m else 'none'} ({kind})" for kind, m in merged.items()),
        note="first period whose closest strobe points merge in amplitude noise of the size of the letter's "
        "stability",
    )


if __name__ == "__main__":
    raise SystemExit(sensitivity.main())
