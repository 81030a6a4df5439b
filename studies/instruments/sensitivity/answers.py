"""What the letter's errors and noise can and cannot explain, in numbers and in words.

p10 at grazing in the map begins at the band edge f T = 20/21.  A period is beyond the noise of the amplitude
where its strobe points run into one another, where the order of its impacts is lost, or where its hysteresis
|F_m/F_g - 1| is smaller than the noise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from beam import ModalModel
from contact.stroboscope import StroboscopicMap
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.sensitivity.grazing_births import NOISE, first_birth, upper_end
from studies.published import DRIVE_AMPLITUDE_M, FREE_PERIOD_ERROR_S

__all__ = ["answers_of", "number", "sentences"]


def answers_of(
    scene: Scene,
    model: ModalModel,
    rows: Sequence[Mapping[str, Any]],
    noise: Sequence[Mapping[str, Any]],
    pool: Any,
) -> dict[str, Any]:
    """What the letter's errors can and cannot explain."""
    last = max(scene.drive.frequencies_hz)
    names = ("map", "single_mode", "beam")
    ten = [row for row in rows if row["frequency_hz"] == last and any(row[f"born_{n}"] == 10 for n in names)]
    period = next(
        row["born_beam"] for row in rows if row["frequency_hz"] == last and row["parameter"] == "none"
    )
    short = scene.replace(
        {"single_mode.free_period_s": scene.single_mode.free_period_s - FREE_PERIOD_ERROR_S}
    )
    jobs: dict[str, Callable[[], float | None]] = {}
    for name, strobed in (
        ("single_mode", StroboscopicMap(oscillator=single_mode_oscillator(scene, last))),
        ("single_mode_short_period", StroboscopicMap(oscillator=single_mode_oscillator(short, last))),
        ("beam", StroboscopicMap(oscillator=beam_of(scene, last, model))),
    ):
        jobs[f"p{period}_lives_up_to_{name}"] = lambda s=strobed: upper_end(s, period)  # type: ignore[misc]
        jobs[f"p10_born_from_{name}"] = lambda s=strobed: first_birth(s, 10)  # type: ignore[misc]
    futures = {name: pool.submit(job) for name, job in jobs.items()}
    merged = {
        kind: next((r["m"] for r in noise if (r[kind]["told_apart"] or 0.0) < 1.0), None)
        for kind in ("jitter", "drift")
    }
    irregular = {
        kind: next((r["m"] for r in noise if r[kind]["regular"] < 0.9), None) for kind in ("jitter", "drift")
    }
    hidden = [
        row["frequency_hz"]
        for row in rows
        if row["parameter"] == "none" and row["m"] > 1 and abs(row["fold_beam"] or 0.0) < NOISE
    ]
    return {
        "noise": NOISE,
        "periods_examined": [noise[0]["m"], noise[-1]["m"]],
        "first_period_with_merged_points": merged,
        "first_period_that_noise_breaks": irregular,
        "first_period_with_hysteresis_below_noise": next(
            (r["m"] for r in noise if r["fold"] is not None and abs(r["fold"]) < NOISE), None
        ),
        "frequencies_with_hysteresis_below_noise_hz": hidden,
        "changes_that_give_p10": [f"{r['parameter']} {r['change']}" for r in ten],
        "free_period_for_p10_at_grazing_s": 20.0 / (21.0 * last),
        **{name: future.result() for name, future in futures.items()},
    }


def number(value: float | None, form: str = "+.2e") -> str:
    """A number or its absence."""
    return "-" if value is None else format(value, form)


def sentences(scene: Scene, answers: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The answers in words."""
    merged, broken = answers["first_period_with_merged_points"], answers["first_period_that_noise_breaks"]
    last = max(scene.drive.frequencies_hz)
    base = {(row["frequency_hz"]): row for row in rows if row["parameter"] == "none"}

    def words(m: int | None) -> str:
        least, most = answers["periods_examined"]
        return f"none up to {most}" if m is None else f"{m} or less" if m == least else str(m)

    other = [
        row
        for row in rows
        if any(
            row[f"born_{n}"] != base[row["frequency_hz"]][f"born_{n}"] for n in ("map", "single_mode", "beam")
        )
    ]
    shortest = 1e3 * answers["free_period_for_p10_at_grazing_s"]
    lines = [
        f"Amplitude noise of {answers['noise']:.1e}, Eq. (1) near the upper edge of each band: the "
        f"closest strobe points of p_m run into one another from m = {words(merged['jitter'])} on with "
        f"jitter, {words(merged['drift'])} with drift; the order of the impacts itself is lost from m = "
        f"{words(broken['jitter'])} with jitter, {words(broken['drift'])} with drift; the hysteresis is "
        f"below the noise from m = {words(answers['first_period_with_hysteresis_below_noise'])} on.",
        "The hysteresis of the beam is below that noise at "
        + (", ".join(f"{f:.2f}" for f in answers["frequencies_with_hysteresis_below_noise_hz"]) or "none")
        + " Hz of the letter's frequencies.",
        f"{last:.2f} Hz: p10 at grazing needs T <= {shortest:.2f} ms; "
        f"changes that give it at excess 1e-3: {', '.join(answers['changes_that_give_p10']) or 'none'}. "
        "Without any change p10 is what is born from excess "
        f"{number(answers['p10_born_from_single_mode'])} (Eq. (1)) or "
        f"{number(answers['p10_born_from_beam'])} (beam) on: a first step past grazing of "
        f"{number(_microns(answers['p10_born_from_beam']), '.1f')} um of 2 mm skips p11.",
        "Born periods other than the scene's: "
        + (
            "; ".join(
                f"{row['frequency_hz']:.2f} Hz, {row['parameter']} {row['change']}: map {row['born_map']}, "
                f"Eq. (1) {row['born_single_mode']}, beam {row['born_beam']}"
                for row in other
            )
            or "none"
        )
        + ".",
    ]
    return lines


def _microns(excess: float | None) -> float | None:
    return None if excess is None else 1e6 * excess * DRIVE_AMPLITUDE_M
