r"""Stiff contact against number of modes: what the exact method costs, what it loses, and where it ends.

The stop pushes with k d; k is counted in the stiffness of mode 1, k_modal = omega_1^2/phi_1^2, and the
frequency of the contact is omega_c = sqrt(k sum phi^2).

Digits. Modal displacements are kept as doubles, so that the tip is known to about u = eps gap, and every
step within the contact moves it by as much against the wall. At a depth d that changes the energy by k d u,
of which the largest part is

    error of the state ~ omega_c u / v,   u = eps gap,   eps = 2^-52,                                      (a)

v the approach speed: the digits go as the root of the stiffness, and the stated accuracy is lost where
(a) equals it, if nothing else is.

Cost. A step of the series covers about two radians of the fastest rate, max(omega_N, omega_c): a soft
contact of many modes costs omega_N t_c/2 steps, a stiff one two. A contact that lasts a whole drive period T
costs omega_c T/2, and is refused as ``ContactTooStiff`` beyond the bound of 1e6 steps.

Limit. For k -> infinity the contact is over before any mode of a finite model has moved, and mode 1 loses
(1 + e) r_N of its velocity, e = 1, r_N = phi_1^2 / sum phi^2: Newton's law for an elastic impact
(``contact.touch.newton``). The kick of the contact, -(jump of the mode-1 tip velocity at the touch)/v with
the free motion of mode 1 taken out, comes there as 1/omega_c.

Units: SI.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from beam.reduction import ModalModel
from contact.errors import ContactTooStiff
from contact.event_loop import MOST_STEPS
from contact.integrators import Exact
from contact.simulation import simulate
from contact.trajectory import State
from studies.instruments.scene import Scene
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.extended_precision import flow_of_doubles
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.odd_springs import (
    GAP,
    SPEED,
    Collided,
    collide,
    error_of_collision,
    spring,
)
from studies.instruments.stability.pressed_contact import pressed
from studies.instruments.stability.stiff_figures import draw_stiff

__all__ = ["digits_lost", "draw", "first_kick", "measure", "newton_limit"]

NAME = "piecewise-linear"
EPS = 2.0**-52
COSTLY = 10.0
"""Below k/k_modal = n_modes^2/10 no error is computed: the reference needs a second and more for the many
radians of the high modes in a long contact, and rounding shows at the stiff end."""
SPEEDS = 6
"""Starts, a part in a hundred apart in speed, of which the worst counts: rounding is a matter of luck."""


def modal_stiffness(model: ModalModel) -> float:
    return float(model.omega[0] ** 2 / model.phi[0] ** 2)


def digits_lost(model: ModalModel, stiffness: float, approach: float) -> float:
    """The size (a) of the error [1]."""
    return float(math.sqrt(stiffness * float(model.phi @ model.phi)) * EPS * GAP / approach)


def worst(model: ModalModel, stiffness: float, starts: int) -> tuple[float, Collided]:
    """Largest error over `starts` collisions, and the last of them."""
    errors = []
    for j in range(starts):
        found = collide(model, stiffness, speed=np.full(model.n_modes, SPEED * (1.0 + 0.01 * j)))
        errors.append(error_of_collision(found))
    return max(errors), found


def newton_limit(model: ModalModel) -> float:
    """Kick of an elastic impact, 2 r_N [1]."""
    return float(2.0 * model.phi[0] ** 2 / (model.phi @ model.phi))


def first_kick(model: ModalModel, stiffness: float) -> float:
    """Kick of mode 1 by one contact that finds the other modes at rest [1]."""
    alone = np.zeros(model.n_modes)
    alone[0] = SPEED
    found = collide(model, stiffness, speed=alone)
    impacts = found.run.impacts
    a = flow_of_doubles(float(model.omega[0]), float(model.decay_rate[0]), found.release - found.touch)
    u, v = impacts.displacement_start[0, 0], impacts.velocity_start[0, 0]
    jump = impacts.velocity_end[0, 0] - (a[2] * u + a[3] * v)
    return float(-model.phi[0] * jump / impacts.approach[0])


def _accuracy(model: ModalModel, stiffness: np.ndarray, quick: bool) -> tuple[list[Limit], dict[str, Any]]:
    """Error and cost over the stiffness, and where the stated accuracy goes."""
    modal, n = modal_stiffness(model), model.n_modes
    starts = 2 if quick else SPEEDS
    errors, costs, theory = [], [], []
    for k in stiffness:
        if n * n <= k * COSTLY:
            error, found = worst(model, k * modal, starts)
        else:
            error, found = math.nan, collide(model, k * modal)
        errors.append(error)
        costs.append(found.run.evaluations)
        theory.append(digits_lost(model, k * modal, float(found.run.impacts.approach[0])))
    errors_soft = np.array(errors)[stiffness <= 1.01e6]
    approach = float(collide(model, 1e6 * modal).run.impacts.approach[0])
    accuracy = Exact.accuracy
    expected = (accuracy * approach / (EPS * GAP)) ** 2 / float(model.phi @ model.phi) / modal
    lost = bisect(
        lambda k: worst(model, k * modal, SPEEDS)[0] > accuracy, 1e-2 * expected, 1e4 * expected,
        relative=0.5 if quick else 0.1,
    )  # fmt: skip
    modes = f"{n} mode{'s' if n > 1 else ''}"
    limits = [
        Limit(
            method=NAME, case=f"{modes}, one collision: the state keeps the stated {accuracy:g}",
            knob="k/k_modal [1]", theory=None, measured=lost, refused=False,
            note=f"(a), the size of the error and no sharp limit, says {expected:.1e}; against 60 digits, "
            f"worst of {SPEEDS} starts; largest error up to k/k_modal = 1e6 {np.nanmax(errors_soft):.1e}; "
            f"not refused beyond, where {-math.log10(errors[-1]):.0f} digits are left at {stiffness[-1]:.0e}",
        )
    ]  # fmt: skip

    table = {"error": errors, "cost": costs, "lost": theory}
    return limits, {f"{name}_{n}": np.array(values) for name, values in table.items()}


def followed() -> Limit:
    """A single collision of one mode, far beyond any real stiffness."""
    model = spring(1)
    highest = 1e18
    digits = -math.log10(worst(model, highest * modal_stiffness(model), SPEEDS)[0])
    return Limit(
        method=NAME, case="1 mode, one collision: is followed to its end", knob="k/k_modal [1]", theory=None,
        measured=None, refused=None,
        note=f"no failure up to the largest tried, k/k_modal = {highest:.0e}, where {digits:.0f} digits are "
        "left: a short contact takes two steps of the series, however stiff",
    )  # fmt: skip


def lasting(quick: bool) -> list[Limit]:
    """A contact that lasts a whole period: the bound of the steps."""
    model = spring(1)
    modal, period = modal_stiffness(model), 2.0 * math.pi / float(model.omega[0])

    def cost(k: float) -> int:
        oscillator, rest = pressed(model, k * modal)
        state = simulate(oscillator, _state(rest), duration=1e-3 * period)
        return int(state.evaluations)

    # steps per radian of the contact, by a thousandth of the period
    trial = 1e12
    per_radian = cost(trial) / (1e-3 * period * math.sqrt(trial * modal) * float(model.phi[0]))
    theory = (MOST_STEPS / (per_radian * period)) ** 2 / model.phi[0] ** 2 / modal

    def refuses(k: float) -> bool:
        oscillator, rest = pressed(model, k * modal)
        try:
            simulate(oscillator, _state(rest), periods=1)
        except ContactTooStiff:
            return True
        return False

    found = bisect(refuses, 0.8 * theory, 1.3 * theory, relative=0.4 if quick else 0.02)
    return [
        Limit(
            method=NAME, case="one mode pressed on the stop for a whole period", knob="k/k_modal [1]",
            theory=theory, measured=found, refused=refuses(1.2 * found),
            note=f"ContactTooStiff beyond {MOST_STEPS:.0e} steps of {1.0 / per_radian:.2f} rad, which was "
            "counted over a thousandth of the period at k/k_modal = 1e12; the step varies by 5 % with k",
        )
    ]  # fmt: skip


def _state(rest: np.ndarray) -> State:
    """The rest position, and a millionth of it beyond."""
    return State(displacement=rest * (1.0 + 1e-6), velocity=np.zeros(rest.size))


def newton(counts: tuple[int, ...], stiffness: np.ndarray) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """The kick over the stiffness, and its limit."""
    limits, arrays = [], {}
    for n in counts:
        model = spring(n)
        modal = modal_stiffness(model)
        kicks = np.array([first_kick(model, k * modal) for k in stiffness])
        arrays[f"kick_{n}"], arrays[f"newton_{n}"] = kicks, np.array([newton_limit(model)])
        high = stiffness > 1e8
        off = np.abs(kicks[high] - newton_limit(model))
        slope = float(np.polyfit(np.log(stiffness[high]), np.log(off), 1)[0])
        limits.append(
            Limit(
                method=NAME, case=f"{n} mode{'s' if n > 1 else ''}: kick of mode 1 as k -> infinity",
                knob="kick at k/k_modal = 1e12 [1]", theory=newton_limit(model), measured=float(kicks[-1]),
                refused=None,
                note="theory is Newton's elastic impact, 2 r_N; the difference falls as "
                f"k^{slope:.2f} above 1e8",
            )
        )  # fmt: skip
    return limits, arrays


def measure(*, quick: bool, scene: Scene) -> Findings:
    """Error, cost and limit of stiff contacts; the spring is a plain one, the same for every scene."""
    counts = (1, 5) if quick else (1, 5, 15)
    stiffness = np.geomspace(1e-2, 1e12, 8 if quick else 15)
    limits: list[Limit] = []
    arrays: dict[str, np.ndarray] = {"stiffness": stiffness, "counts": np.array(counts)}
    for n in counts:
        rows, table = _accuracy(spring(n), stiffness, quick)
        limits += rows
        arrays |= table
    limits += [followed(), *lasting(quick)]
    fine = np.geomspace(1e0, 1e12, 13 if quick else 49)
    rows, table = newton((*counts, 15) if quick else counts, fine)
    return Findings(limits=[*limits, *rows], arrays={**arrays, **table, "kick_stiffness": fine})


def draw(findings: Findings, record: Any) -> None:
    """Error, cost and kick over the stiffness."""
    record.write_figure(draw_stiff(findings.arrays), "stiff_contact")
