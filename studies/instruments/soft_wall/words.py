"""What the study of the soft wall says: the table and the answers, in numbers and in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from scipy.optimize import brentq

from studies.instruments.oscillators import single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.soft_wall.soft_impact import SoftImpact, damping_ratio
from studies.published import AMPLITUDE_STABILITY_M, DRIVE_AMPLITUDE_M

RESOLUTION = AMPLITUDE_STABILITY_M / DRIVE_AMPLITUDE_M
"""The letter's amplitude stability over its amplitude, 2.5e-4."""


def visible_hardness(scene: Scene, frequency: float) -> float | None:
    """K above which the period doubling lies within the letter's amplitude stability."""
    oscillator = single_mode_oscillator(scene, frequency)

    def beyond(log_hardness: float) -> float:
        wall = SoftImpact.of_mode(oscillator, hardness=math.exp(log_hardness))
        peak = wall.doubling_peak()
        return 1.0 if peak is None else math.log(wall.excess_of(peak) / RESOLUTION)

    low, high = math.log(1.0 + 1e-3), math.log(1e8)
    return math.exp(float(brentq(beyond, low, high, xtol=1e-6))) if beyond(high) < 0.0 else None


def answers_of(
    scene: Scene,
    rows: Sequence[Mapping[str, Any]],
    curves: Any,
    exponents: Mapping[str, Any],
    beam: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """What was found, in numbers and in words."""
    frequencies = sorted({row["frequency_hz"] for row in rows})
    hardest = max(row["K"] for row in rows)
    zeta = damping_ratio(scene.single_mode.restitution)
    ratios = [
        abs(r["excess_pd_measured"] / r["excess_pd_leading"] - 1.0) * r["K"]
        for r in rows
        if r["case"] == "lossless" and r["excess_pd_measured"] and 1e4 <= r["K"] <= 1e5
    ]
    sharper = [
        abs(r["excess_pd_measured"] / r["excess_pd_theory"] - 1.0)
        for r in rows
        if r["case"] == "lossless" and r["excess_pd_measured"] and 1e4 <= r["K"] <= 1e5
    ]
    damped = [r for r in rows if r["case"] == "dashpot"]
    touching = [r for r in damped if r.get("unstable_from") is not None]
    steep = [r for r in damped if r.get("excess_pd_theory") == 0.0]
    found: dict[str, Any] = {
        "damping_ratio": zeta,
        "kick_rates": {f"{c['case']} K={c['K']:g}": c["rate_of_error"] for c in curves},
        "doubling_error_times_K": [min(ratios), max(ratios)] if ratios else None,
        "doubling_closed_form_error": max(sharper) if sharper else None,
        "doubling_shortfall_times_K": {
            f"{f:g}": SoftImpact.of_mode(single_mode_oscillator(scene, f), hardness=2.0).leading_shortfall
            for f in frequencies
        },
        "least_hardness": {
            f"{f:g}": SoftImpact.of_mode(single_mode_oscillator(scene, f), hardness=2.0).least_hardness
            for f in frequencies
        },
        "visible_below_hardness": {f"{f:g}": visible_hardness(scene, f) for f in frequencies},
        "dashpot_unstable_from_grazing": [len(touching), len(steep), len(damped)],
        "hysteresis_exponents": exponents,
    }
    lines = [
        f"a restitution of {scene.single_mode.restitution:g} from spring and dashpot needs a damping ratio "
        f"of {zeta:.4f}: overdamped, and the force sets in with c v; "
        "the kick of small peaks is then c h, not h^(3/2)",
    ]
    if ratios and sharper:
        lines.append(
            "lossless: p1 survives grazing and doubles; measured over the formula for K -> infinity is 1 up "
            "to "
            f"{min(ratios):.1f}/K to {max(ratios):.1f}/K, over the closed form 1 up to {max(sharper):.0e}, "
            "for K from 1e4 to 1e5"
        )
    limits = [(f, K) for f, K in found["visible_below_hardness"].items() if K]
    if limits:
        lines.append(
            "the doubling lies above the letter's amplitude stability only for K below "
            + ", ".join(f"{K:.0f} at {f} Hz" for f, K in limits)
        )
    lines.append(
        "with the dashpot p1 is unstable from its first touch on, as with a hard wall, in "
        f"{len(touching)} of {len(steep)} cases with c > Lambda (of {len(damped)} in all): a wall that loses "
        "that much hides the smoothing"
    )
    for case in ("lossless", "dashpot"):
        powers_found = [
            e["shift"] for key, e in exponents.items() if key.endswith(case) and e["shift"] is not None
        ]
        rests = [
            e["remainder"] for key, e in exponents.items() if key.endswith(case) and e["shift"] is not None
        ]
        if powers_found:
            lines.append(
                f"{case}: the end of p_m nears the hard wall's as K to the power {min(powers_found):.3f} "
                f"to {max(powers_found):.3f} from K = 1e7 to 1e8, what the closed form leaves as "
                f"K to the power {min(rests):.3f} to {max(rests):.3f}"
            )
    if beam is not None:
        lines += beam_lines(beam, scene)
        wall = SoftImpact.of_mode(single_mode_oscillator(scene, beam["frequency_hz"]), hardness=hardest)
        if beam["half_excess"]:
            found["beam_equivalent_K"] = 1.0 + wall.half_peak * (wall.hardness - 1.0) / beam["half_excess"]
            lines.append(
                "a lossless soft wall has half of its kick at the same excess for "
                f"K = {found['beam_equivalent_K']:.2g}"
            )
    return found | {"sentences": lines}


def beam_lines(beam: Mapping[str, Any], scene: Scene) -> list[str]:
    """The beam in words."""

    def told(value: float | None) -> str:
        return "no excess looked at" if value is None else f"{value:.2g}"

    grazing = DRIVE_AMPLITUDE_M * 1e9
    gently = [row for row in beam["born"] if row["period_gently"] is not None]
    p1 = [row["excess"] for row in gently if row["period_gently"] == 1]
    beyond = sorted({row["period_gently"] for row in gently if row["excess"] > (max(p1) if p1 else 0.0)})
    steps = sorted(
        {row["period_in_one_step"] for row in beam["born"] if row["period_in_one_step"] is not None}
    )
    lines = [
        f"beam with Hertz contact at {beam['frequency_hz']:.2f} Hz: the kick has half of its plateau at "
        f"{told(beam['half_excess'])}, the local power is within 0.1 of one half from "
        f"{told(beam['square_root_from'])} "
        f"on and above 1.9 (Hertz: 2) up to {told(beam['square_law_up_to'])}"
    ]
    if beam["doubling_excess"]:
        size = beam["doubling_excess"]
        lines.append(
            f"the p1 orbit with impacts lives from 0 to {size:.3g} ({grazing * size:.2g} nm of a 2 mm drive; "
            "formula "
            f"{beam['doubling_theory']:.3g}), then the motion settles on p"
            f"{', p'.join(str(p) for p in beyond if p) or '?'}; the letter's amplitude is stable to "
            f"{RESOLUTION:.2g}, {RESOLUTION / size:.0f} times more"
        )
    limits = [value for value in beam["doubling_theory_by_frequency"].values() if value is not None]
    if limits:
        lines.append(
            f"over the drive frequencies the formula gives {min(limits):.2g} to {max(limits):.2g} for its end"
        )
    lines.append(
        "raised in one step from 1e-3 below grazing, the beam settles on p"
        + ", p".join(str(p) for p in steps)
        + " throughout"
    )
    return lines


HEAD = (
    f"{'f (Hz)':>7} {'wall':>9} {'K':>7} {'crossover':>10} {'powers':>12} {'doubling':>10} {'formula':>10} "
    f"{'K -> inf':>10} {'sides':>8} {'p_m end':>11} {'hard wall':>11}"
)


def table_line(row: Mapping[str, Any]) -> str:
    """A row of the table on the terminal."""

    def number(key: str, form: str = ".3e") -> str:
        value = row.get(key)
        return "-" if value is None else format(value, form)

    sides = "-" if row.get("period_below") is None else f"p{row['period_below']}|p{row['period_above']}"
    return (
        f"{row['frequency_hz']:7.2f} {row['case']:>9} {row['K']:7.0e} "
        f"{number('crossover_excess', '.2e'):>10} "
        f"{number('slope_below', '.3f') + ' ' + number('slope_above', '.3f'):>12} "
        f"{number('excess_pd_measured'):>10} {number('excess_pd_theory'):>10} "
        f"{number('excess_pd_leading'):>10} "
        f"{sides:>8} {number('hysteresis', '+.3e'):>11} {number('hysteresis_hard', '+.3e'):>11}"
    )
