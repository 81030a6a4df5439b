"""Loss that a method adds to an elastic collision, and the restitution that it fakes.

The spring of the scene with `MODES` modes meets the plate once, at the excess of the letter's Fig. 4, under
an elastic law: Hertz's, or Newton's with e = 1.  The exact motion has an effective restitution tau and a kick
(``contact.collision``) because energy goes into the higher modes; a method that damps has others,

    false tau = tau(h) - tau,      false kick = kick(h) - kick,

and the kick of a single short contact is nearly in proportion to 1 + e of the contact itself, so that
2 kick(h)/kick - 1 is about the local restitution that a method of restitution 1 pretends to have.  Energy is
lost in the contact, and over the drive period that follows (``elastic_collision``).  Steps are given in
contact times under Hertz's law, as h omega_max under Newton's; each value is a mean over places of the touch
in its step.

Moreau and Jean's scheme lets the tip pass the stop: an impact happens at the first mid-step point behind it,
so at most h U behind it, U the velocity of the tip; while a contact lasts the penetration stays.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from contact.integrators.generalised_alpha import GeneralisedAlpha
from contact.integrators.moreau_jean import MoreauJean
from contact.integrators.nonsmooth_generalised_alpha import NonsmoothGeneralisedAlpha
from contact.laws import NewtonRestitution
from contact.simulation import simulate
from contact.stop import Stop
from studies.instruments.figures import PAGE, in_house_style, label, new_figure, panel, series
from studies.instruments.oscillators import beam_of
from studies.instruments.record import Record
from studies.instruments.scene import Scene
from studies.instruments.stability.elastic_collision import ElasticCollision, Maker
from studies.instruments.stability.findings import Findings, Limit

__all__ = ["draw", "measure"]

MODES = 10
EXCESS = 0.013
"""That of the letter's Fig. 4."""

TOLERATED = 0.01
"""Error of restitution at which a step counts as too large: a tenth of the letter's tau."""

QUANTITIES = ("effective restitution", "kick of mode 1", "energy lost in a period")

HERTZ: dict[str, Maker] = {
    "trapezoidal rule": lambda h: GeneralisedAlpha.newmark(step=h),
    "HHT, α = 0.1": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.1),
    "HHT, α = 0.3": lambda h: GeneralisedAlpha.hht(step=h, alpha=0.3),
    "gen.-α, ρ = 0.8": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.8),
    "gen.-α, ρ = 0": lambda h: GeneralisedAlpha.with_dissipation(step=h, rho=0.0),
}
NEWTON: dict[str, Maker] = {
    "Moreau-Jean, θ = 1/2": lambda h: MoreauJean(step=h),
    "Moreau-Jean, θ = 1": lambda h: MoreauJean(step=h, theta=1.0),
    "nonsmooth, ρ = 0.8": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.8),
    "nonsmooth, ρ = 0": lambda h: NonsmoothGeneralisedAlpha(step=h, rho=0.0),
}


def _ladder(
    case: ElasticCollision, methods: dict[str, Maker], sizes: np.ndarray, places: int
) -> dict[str, np.ndarray]:
    """Restitution and kick, mean and spread, and both losses for every method and step."""
    arrays: dict[str, np.ndarray] = {}
    for name, make in methods.items():
        rows = np.empty((6, sizes.size))
        for j, size in enumerate(sizes):
            found, lost = [], []
            for i in range(places):
                # steps of the same size that put the touch at different places of theirs
                step = float(size) * case.unit * (1.0 + 0.03 * (i / places - 0.5))
                found.append(case.measured(make(step)))
                if i % 2 == 0:
                    lost.append(case.lost(make(step), step, (i + 0.5) / places))
            # one place without a collision, or with a kick but no return, and the whole step has none
            pairs, losses = np.array(found), np.array(lost)
            rows[:, j] = [*pairs.mean(axis=0), *pairs.std(axis=0), *losses.mean(axis=0)]
        arrays[name] = rows
    return arrays


def _reached(sizes: np.ndarray, error: np.ndarray, bound: float) -> float | None:
    """The step from which on `error` exceeds `bound`, between grid values by their logarithms; NaN counts as
    beyond every bound."""
    below = np.flatnonzero(error <= bound)
    if below.size == 0 or below[-1] == error.size - 1:
        return None
    i = int(below[-1])
    if not math.isfinite(error[i + 1]):
        return float(sizes[i + 1])
    x = math.log(bound / error[i]) / math.log(error[i + 1] / error[i])
    return float(sizes[i] * (sizes[i + 1] / sizes[i]) ** x)


def _rows(
    case: ElasticCollision, methods: dict[str, Maker], found: dict[str, np.ndarray], sizes: np.ndarray,
    knob: str, law: str,
) -> list[Limit]:  # fmt: skip
    """Where restitution goes wrong, for each method, and by how much at a step of about one unit."""
    rows = []
    for name, table in found.items():
        error = np.hypot(table[0] - case.exact.restitution, table[2])
        # the step next to one unit, or the largest below it at which there is a restitution at all
        last = int(np.flatnonzero(np.isfinite(table[0]) & (sizes < 1.1))[-1])
        local = 2.0 * table[1, last] / case.exact.kick - 1.0
        measured = _reached(sizes, error, TOLERATED)
        whole = bool(np.isfinite(table[0]).all())
        lost = "" if whole else " or its damping keeps mode 1 from touching or returning"
        rows.append(Limit(
            method=methods[name](case.unit).name,
            case=f"{name}, elastic {law}, tau = {case.exact.restitution:.4f}", knob=knob, theory=None,
            measured=measured, refused=False if measured is not None else None,
            note=(
                ("" if measured is None else f"rms error of tau reaches {TOLERATED}{lost}; ")
                + f"at {sizes[last]:.3g} tau is {table[0, last]:.4f}, the kick pretends a local restitution "
                f"of {local:.3f}, and {table[4, last]:.2g} of mode 1's approach energy is lost in the "
                f"contact, {table[5, last]:.2g} within a period"
            ),
        ))  # fmt: skip
    return rows


def _penetration(case: ElasticCollision, quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """How far Moreau and Jean's scheme lets the tip pass the stop; and that a pressed tip stays."""
    sizes = np.geomspace(1e-2, 1.0, 5 if quick else 11)
    lossy = Stop(gap=case.driven.stop.gap, law=NewtonRestitution(local_restitution=0.5))
    spring = replace(case.driven, stop=lossy)
    unit = 1.0 / float(spring.model.omega.max())
    deepest, ratio = np.empty(sizes.size), np.empty(sizes.size)
    for j, size in enumerate(sizes):
        step = float(size) * unit
        method = MoreauJean(step=step)
        impacts = simulate(spring, case.start, periods=10 if quick else 60, method=method).impacts
        depth = impacts.displacement_start @ spring.model.phi - spring.stop.gap
        fast = impacts.approach > 0.0
        deepest[j] = float(depth.max())
        ratio[j] = float(np.max(depth[fast] / (step * impacts.approach[fast])))
    law = NewtonRestitution(local_restitution=0.0)
    load = np.zeros(spring.n_modes)
    load[0] = 2.0 * spring.stop.gap * spring.model.omega[0] ** 2 / spring.model.phi[0]
    held = replace(spring, drive=None, load=load, stop=Stop(gap=spring.stop.gap, law=law))
    step = 0.1 * unit
    times = np.array([0.5, 1.0]) * (2_000_000 if quick else 20_000_000) * step
    motion = simulate(held, duration=float(times[-1]), times=times, method=MoreauJean(step=step))
    depth = motion.displacement @ held.model.phi - held.stop.gap
    unit_depth = step * float(motion.impacts.approach.max())
    rows = [
        Limit(
            method="moreau-jean", case="driven spring, e = 0.5, penetration at an impact",
            knob="penetration / (h U) [1]", theory=1.0, measured=float(ratio.max()), refused=None,
            note=f"largest of all impacts, h omega_max {sizes[0]:g} to {sizes[-1]:g}; theory is a bound; "
            f"{deepest[0]:.2g} to {deepest[-1]:.2g} m",
        ),
        Limit(
            method="moreau-jean", case="pressed on the stop, e = 0, change of the penetration",
            knob="change / (h U) [1]", theory=0.0, measured=float((depth[1] - depth[0]) / unit_depth),
            refused=None, note=f"over the last {times[0] / step:.3g} steps; it stays {depth[1]:.2g} m deep",
        ),
    ]  # fmt: skip
    return rows, {"penetration_h_omega": sizes, "penetration": deepest, "penetration_ratio": ratio}


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Both laws; `quick` takes fewer steps and places."""
    middle = sorted(scene.drive.frequencies_hz)[len(scene.drive.frequencies_hz) // 2]
    kept = scene.replace({"modes.count": MODES, "contact.law": "hertz"})
    hertz = ElasticCollision.of(beam_of(kept, middle).with_excess(EXCESS), None)
    hard = replace(
        hertz.driven, stop=Stop(gap=hertz.driven.stop.gap, law=NewtonRestitution(local_restitution=1.0))
    )
    newton = ElasticCollision.of(hard, 1.0 / float(hard.model.omega.max()))
    places = 4 if quick else 12
    hertz_sizes = np.geomspace(1 / 16, 2.0, 6) if quick else np.geomspace(1 / 64, 4.0, 13)
    newton_sizes = np.geomspace(1 / 64, 2.0, 6) if quick else np.geomspace(1 / 256, 4.0, 15)
    by_spring = _ladder(hertz, HERTZ, hertz_sizes, places)
    by_impact = _ladder(newton, NEWTON, newton_sizes, places)
    drift, drift_arrays = _penetration(hertz, quick)
    arrays: dict[str, Any] = {
        "hertz_h": hertz_sizes, "newton_h": newton_sizes,
        "hertz_exact": np.array([hertz.exact.restitution, hertz.exact.kick]),
        "newton_exact": np.array([newton.exact.restitution, newton.exact.kick]),
        **{f"hertz {name}": table for name, table in by_spring.items()},
        **{f"newton {name}": table for name, table in by_impact.items()},
        **drift_arrays,
    }  # fmt: skip
    return Findings(
        limits=[
            *_rows(hertz, HERTZ, by_spring, hertz_sizes, "h / contact time [1]", "Hertz contact"),
            *_rows(newton, NEWTON, by_impact, newton_sizes, "h omega_max [1]", "impacts"), *drift,
        ],
        arrays=arrays,
    )  # fmt: skip


@in_house_style
def draw(findings: Findings, record: Record) -> None:
    """Restitution, kick and loss against the step for both laws; penetration."""
    arrays = findings.arrays
    figure, axes = new_figure(2, 3, width=PAGE, height=0.124)
    unit = {"hertz": "$h$ / contact time", "newton": "$h\\,\\omega_\\mathrm{max}$"}
    for row, (law, methods) in enumerate((("hertz", HERTZ), ("newton", NEWTON))):
        sizes, exact = arrays[f"{law}_h"], arrays[f"{law}_exact"]
        for i, name in enumerate(methods):
            table = arrays[f"{law} {name}"]
            for column in (0, 1):
                axes[row, column].errorbar(
                    sizes, table[column], yerr=table[2 + column], **series(i), label=name, elinewidth=0.6,
                    markevery=max(1, sizes.size // 6), errorevery=max(1, sizes.size // 6),
                )  # fmt: skip
            axes[row, 2].plot(sizes, table[5], **series(i), markevery=max(1, sizes.size // 6), gid=name)
        for column, words in enumerate(QUANTITIES):
            axis = axes[row, column]
            axis.set_xscale("log")
            panel(axis, 3 * row + column, "Hertz contact" if law == "hertz" else "Newton's law, e = 1")
            label(axis.xaxis, unit[law], "1")
            label(axis.yaxis, words, "1")
            if column < 2:
                axis.axhline(exact[column], color="0.5", linewidth=0.8, linestyle=":", gid="exact")
            else:
                axis.axhline(0.0, color="0.5", linewidth=0.8, linestyle=":", gid="no loss")
                axis.set_yscale("symlog", linthresh=1e-3)
        axes[row, 0].legend(loc="upper left")
    record.write_figure(figure, "numerical_restitution")
    figure, axis = new_figure(height=0.06)
    sizes = arrays["penetration_h_omega"]
    axis.plot(sizes, 1e6 * arrays["penetration"], **series(0), label="deepest of a run")
    axis.plot(
        sizes, 1e6 * arrays["penetration"][0] * sizes / sizes[0], color="0.5", linestyle=":",
        label="slope 1",
    )  # fmt: skip
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.legend(loc="upper left")
    label(axis.xaxis, "$h\\,\\omega_\\mathrm{max}$", "1")
    label(axis.yaxis, "penetration, Moreau-Jean", "µm")
    record.write_figure(figure, "moreau_jean_penetration")
