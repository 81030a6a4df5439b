"""One parameter of the scene changed at a time: the letter's errors, then the free assumptions.

T, mu within their errors, tau between 0.05 and 0.15, and the free assumptions of the spring.  A change of the
spring goes with the thickness of the sheet that keeps T; the rate of mode 1, gap and mass stay.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from beam import ModalModel
from studies.instruments.calibration import calibrate_damping, free_period, solve_for
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.published import BREAKDOWN, FREE_PERIOD_ERROR_S

__all__ = ["Change", "changed", "changes_of"]


@dataclass(frozen=True, kw_only=True)
class Change:
    """One parameter changed: keys of the scene, or what has no key.

    Parameters
    ----------
    parameter, text : str
        Name, and the change in words.
    sign : int
        -1 or 1: lowered or raised.
    keys : mapping
        Dotted keys with their new values.
    tune : bool
        Whether the sheet has to be refitted to the free period.
    higher_damping : float
        Factor on the decay rates of modes above the first.
    """

    parameter: str
    text: str
    sign: int
    keys: Mapping[str, Any] = field(default_factory=dict)
    tune: bool = False
    higher_damping: float = 1.0


def changes_of(scene: Scene, quick: bool) -> list[Change]:
    """What is varied: first the letter's own errors, then the assumptions."""
    t, c, tau = (
        scene.single_mode.free_period_s,
        scene.single_mode.decay_rate_per_s,
        scene.single_mode.restitution,
    )
    rate = float(BREAKDOWN["decay_rate_error_per_s"])
    found = []
    for sign, name in ((-1, "-"), (1, "+")):
        found += [
            Change(
                parameter="free period",
                text=f"{name}0.02 ms",
                sign=sign,
                tune=True,
                keys={"single_mode.free_period_s": t + sign * FREE_PERIOD_ERROR_S},
            ),
            Change(
                parameter="decay rate of mode 1",
                text=f"{name}0.1 1/s",
                sign=sign,
                keys={"single_mode.decay_rate_per_s": c + sign * rate},
            ),
            Change(
                parameter="restitution of Eq. (1)",
                text=f"{name}0.05",
                sign=sign,
                keys={"single_mode.restitution": min(max(tau + sign * 0.05, 0.0), 1.0)},
            ),
            Change(
                parameter="damping of higher modes",
                text="x 0.5" if sign < 0 else "x 2",
                sign=sign,
                higher_damping=2.0**sign,
            ),
        ]
        if quick:
            continue
        found += [
            Change(
                parameter=words,
                text=f"x {factor:g}",
                sign=sign,
                tune=tune,
                keys={key: scene[key] * factor},
            )
            for words, key, low, high, tune in (
                ("mass of ball and mount", "tip.mass_kg", 0.8, 1.2, True),
                ("gap", "stop.gap_m", 0.8, 1.25, False),
                ("radius of the ball", "tip.ball_radius_m", 0.5, 2.0, False),
                ("radius of the bend", "spring.bend_radius_m", 0.7, 1.3, True),
                ("width of the strip", "spring.width_m", 0.7, 1.3, True),
                ("modulus of the tape", "spring.tape_modulus_pa", 0.5, 2.0, True),
                ("coverage of the tape", "spring.tape_coverage", 0.75, 1.25, True),
            )
            for factor in [low if sign < 0 else high]
            if key != "spring.tape_coverage" or scene[key] * factor <= 1.0
        ]
        count = scene.kept_modes
        found.append(
            Change(
                parameter="number of modes",
                text=f"{count - 5 if sign < 0 else count + 5}",
                sign=sign,
                keys={"modes.count": max(1, count - 5) if sign < 0 else count + 5},
            )
        )
    return found


def changed(scene: Scene, change: Change | None) -> tuple[Scene, ModalModel]:
    """Scene and modes after a change; None for none."""
    if change is None:
        return scene, model_of(scene)
    target = change.keys.get("single_mode.free_period_s", free_period(scene))
    scene = scene.replace(change.keys)
    if "single_mode.decay_rate_per_s" in change.keys:
        rate = change.keys["single_mode.decay_rate_per_s"]
        scene = (
            scene.replace({"damping.decay_rate_per_s": rate})
            if scene.damping.kind == "strips"
            else calibrate_damping(scene, rate)
        )
    if change.tune:
        h = scene.spring.thickness_m
        scene = solve_for(
            "spring.thickness_m",
            scene,
            free_period,
            target,
            name="free period",
            unit="s",
            low=0.7 * h,
            high=1.4 * h,
        )
    model = model_of(scene)
    rates = np.array(model.decay_rate)
    rates[1:] *= change.higher_damping
    return scene, replace(model, decay_rate=rates)
