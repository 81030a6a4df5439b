"""What a person reads about one approach to the plate: a table, and the answers in sentences."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from studies.instruments.effective_impact.approaches import select

__all__ = ["closing_lines", "table"]

LINES_PER_SERIES = 7
"""A table on a terminal shows this many cells of each series, evenly spread; collisions.csv has all."""

SHOWN = ("speed", "modes", "mass", "orbit", "stiffness", "materials", "damping", "loss")


def table(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Some rows of each curve."""
    lines = []
    for curve in SHOWN:
        for name in dict.fromkeys(r["series"] for r in rows if r["curve"] == curve):
            found = select(rows, curve, name)
            if not found:
                continue
            step = max(1, math.ceil(len(found) / LINES_PER_SERIES))
            kept = [found[i] for i in sorted({*range(0, len(found), step), len(found) - 1})]
            lines.append(f"{curve}, {name}")
            lines.append(
                f"{kept[0]['varied']:>30} {'v (m/s)':>9} {'tau':>7} {'delay (ms)':>11} {'kick':>7} "
                f"{'impacts':>8}"
            )
            lines += [
                f"{r['value']:30.5g} {_cell(r['approach_velocity'], 9, 4)} {_cell(r['restitution'], 7, 4)} "
                f"{_cell(1e3 * r['delay_s'], 11, 4)} {_cell(r['kick'], 7, 4)} {r['impacts']:8d}"
                for r in kept
            ]
    return lines


def _cell(value: float, width: int, digits: int) -> str:
    return f"{value:{width}.{digits}f}" if math.isfinite(value) else f"{'-':>{width}}"


def closing_lines(answers: Mapping[str, Any]) -> list[str]:
    """The answers."""
    return [
        *_restitution_lines(answers["local_loss"], answers["smallest_restitution"]),
        *_delay_lines(answers["reference"], answers["clusters"]),
        *_mode_lines(answers["modes"]),
        *_fade_lines(answers["fade"], answers["amplitude_resolution"]),
        *_closed_lines(answers["hard_stop"], answers["closed_forms"]),
    ]


def _number(value: float | None, form: str = ".3g") -> str:
    return "none found" if value is None or not math.isfinite(value) else format(value, form)


def _restitution_lines(loss: Mapping[str, Any], least: Mapping[str, Any]) -> list[str]:
    lossy = [f for f in loss["by_local_restitution"] if math.isfinite(f["restitution"])]
    span = ""
    if lossy:
        low, high = min(lossy, key=lambda f: f["value"]), max(lossy, key=lambda f: f["value"])
        span = (
            f" (tip mass {_number(high['mass_ratio'])} of the leaf at local restitution {high['value']:g}, "
            f"{_number(low['mass_ratio'])} at {low['value']:g})"
        )
    orbits = loss["settled_orbits"]
    among = [cell["restitution"] for cell in orbits["orbits"]]
    return [
        f"restitution {loss['target']:g} in the first collision at excess {loss['excess']:g}: "
        f"{loss['verdict']}; smallest over tip mass {_number(loss['elastic_floor'])} without local loss, "
        f"{_number(loss['lossy_floor'])} with{span}",
        f"what would give it: {_number(loss['hardness_needed'])} times the contact stiffness (a contact of "
        f"{_number(1e6 * loss['contact_time_needed_s'])} us), or an excess of "
        f"{_number(loss['excess_needed'])}",
        "in the orbits that settle at 21.50 Hz and that excess, restitution "
        + (f"{min(among):.2g} to {max(among):.2g}" if among else "not found")
        + ", at most the target at tip masses "
        + (", ".join(f"{r:.3g}" for r in orbits["mass_ratios_below_target"]) or "none")
        + " of the leaf (0: no return to the gap)",
        f"smallest restitution at excess {loss['excess']:g}, elastic: {_number(least['restitution'])} at "
        f"a tip mass of {_number(least['mass_ratio'])} of the leaf, kick {_number(least['kick'])}",
    ]


def _delay_lines(reference: Mapping[str, Any], many: Mapping[str, Any]) -> list[str]:
    masses = [f"{m} from {e:g}" for m, e in many["first_excess_by_mass_ratio"].items() if e is not None]
    hard = [f"{name} from {s:.3g}" for name, s in many["first_stiffness_ratio"].items() if s is not None]
    speed = [f"{name} from {e:.2g}" for name, e in many["first_excess"].items() if e is not None]
    return [
        f"delay at excess {reference['excess']:g}: {_number(1e3 * reference['delay_s'])} ms, "
        f"{_number(reference['delay_over_arc'])} of the arc v/a = {_number(1e3 * reference['arc_s'])} ms",
        "more than one impact: tip mass over leaf and excess "
        + ("; ".join(masses) or "never")
        + "; excess "
        + ("; ".join(speed) or "never")
        + "; contact over tip stiffness "
        + ("; ".join(hard) or "never"),
    ]


def _mode_lines(modes: Mapping[str, Any]) -> list[str]:
    still = [
        f"{name} from {found['modes']} on" for name, found in modes.items() if found["modes"] is not None
    ]
    never = [
        f"{name} (drift {_number(found['drift'])}, {found['impacts']} impacts, beyond "
        + ", ".join(f"{n} in {count} modes" for n, count in found.get("impacts_beyond", {}).items()) + ")"
        for name, found in modes.items() if found["modes"] is None
    ]
    return ["modes needed: " + ("; ".join(still) or "no series stands still")] + (
        ["not settled with the modes at hand: " + "; ".join(never)] if never else []
    )


def _fade_lines(fades: Mapping[str, Any], resolution: float) -> list[str]:
    return [
        f"{name}: kick {_number(found['plateau'])} at most, half of it at excess "
        f"{_number(found['half_excess'])}; {_number(100 * found['share_at_resolution'])} % of it at the "
        f"amplitude stability {resolution:g}, "
        f"{_number(100 * found['share_at_born_excess'])} % where born periods are read"
        for name, found in fades.items()
        if math.isfinite(found["plateau"])
    ]


def _closed_lines(hard: Mapping[str, float], forms: Mapping[str, float]) -> list[str]:
    return [
        f"stop {_number(hard['stiffness_ratio'])} times as stiff as the tip: kick {_number(hard['kick'])}; "
        f"the ball by itself, 2 M phi_1^2: {_number(hard['ball_limit'])}",
        f"closed forms of restitution and delay in {forms['collisions']} collisions with one impact: "
        f"off by at most {_number(forms['restitution'])} and {_number(forms['delay_over_arc'])} arcs",
    ]
