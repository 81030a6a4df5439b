r"""Limits of splitting in a contact that lasts: by closed form, its resonances, order 4, Hertz, refusals.

The tip is pressed on the stop; a step is then an affine map x -> M x + b of x = (q, q'), as long as every
kick finds the tip in contact, and unstable if an eigenvalue of M lies outside the unit circle.

    order 2, omega_N h < pi   k_crit = 1/X,  X = h sum_k phi_k^2 B_k/(1 + A_k + D_k + e_k),                (a)
                              without damping X = h sum_k phi_k^2 tan(omega_k h/2)/(2 omega_k)
    order 4, omega_N h < pi   the lowest root of det(M(k) + I), a polynomial in k, without damping         (b)
    else                      the lowest k at which the spectral radius of M exceeds one                   (c)

((A, B; C, D) the flow of a mode over h, e its determinant; see ``contact.integrators.splitting_limit``).
Beyond pi a resonance of step and contact, omega_j h + omega_k h = 2 pi m, opens a tongue of instability that
closes again for a longer step; damping closes the narrow ones and widens others.

Measured is the motion.  The state that a step leaves as it is (`settled`: Newton's method, the slopes from
differences of marches) differs from the rest position by the error of the method.  A disturbance of it by
1e-9 counts as growing if it has grown 1e5-fold within `STEPS` steps, or has opened the contact.  At order 4
an inner kick of a long step may find the tip off the stop even at rest: the map is then affine in pieces, M
is not its slope, and theory and measurement speak of two things.

Units: SI; k_modal = omega_1^2/phi_1^2 is the stiffness of mode 1 at the tip, omega_N the highest frequency of
the spring without contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from beam import ModalModel
from contact.errors import Diverged, StepTooLarge
from contact.integrators.splitting import COMPOSITIONS, Splitting
from contact.integrators.splitting_limit import closed_form_limit, spectral_radius
from contact.laws import LinearContact
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import State
from studies.instruments.oscillators import hertz_of
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.stability.bisection import bisect
from studies.instruments.stability.findings import Findings, Limit
from studies.instruments.stability.pressed_contact import disturbed, pressed, pressed_hertz
from studies.instruments.stability.splitting_figures import draw_planes, draw_tongues

__all__ = ["NAME", "draw", "growth", "measure", "settled"]

NAME = Splitting.name
STEPS = 20_000
DISTURBANCE, GROWTH = 1e-9, 1e5
SHARE = 0.01
"""How far within and beyond a limit a refusal is tried, relative."""
LENGTHS = (20, 150, 1000)
"""Steps of the short marches that go before a long one."""
SLOPE = 1e-4
"""Size of the displacements from which slopes are taken, relative to the state."""


def _after(oscillator: ImpactOscillator, method: Splitting, x: np.ndarray) -> np.ndarray:
    """One step of the method from x = (q, q')."""
    n = oscillator.n_modes
    start = State(displacement=x[:n], velocity=x[n:])
    end = simulate(oscillator, start, duration=method.step, method=method).end
    return np.concatenate([end.displacement, end.velocity])


def settled(oscillator: ImpactOscillator, method: Splitting, rest: np.ndarray) -> tuple[State, float]:
    """The state of a pressed tip that a step leaves as it is, and the spectral radius of the step there.

    Newton's method from the position `rest`; the slopes are differences of marches, exact where the map is
    piecewise affine.  The rounding of the tip's place, 1e-16 of its deflection by the load alone, limits
    both: the deflection is up to 1e6 of the penetration here.  If Newton's method does not end, the last
    state is given.
    """
    omega, n = oscillator.model.omega, oscillator.n_modes
    weight = np.concatenate([omega, np.ones(n)])
    x = np.concatenate([rest, np.zeros(n)])
    slope = np.eye(2 * n)  # of (omega q, q')
    for _ in range(8):
        here = _after(oscillator, method, x)
        size = SLOPE * np.abs(weight * x).max()
        for j in range(2 * n):
            moved = x.copy()
            moved[j] += size / weight[j]
            slope[:, j] = weight * (_after(oscillator, method, moved) - here) / size
        residual = weight * (here - x)
        if np.abs(residual).max() <= 1e-11 * np.abs(weight * x).max():
            break
        x = x + np.linalg.solve(np.eye(2 * n) - slope, residual) / weight
    radius = float(np.abs(np.linalg.eigvals(slope)).max())
    return State(displacement=x[:n], velocity=x[n:]), radius


def growth(oscillator: ImpactOscillator, method: Splitting, rest: np.ndarray, steps: int = STEPS) -> float:
    """Growth of a disturbance per step, as a logarithm; infinite if it opens the contact at once.

    Taken where it grows from the root of `GROWTH` to `GROWTH`, or over the second half of a run in which it
    does not get there.
    """
    at_rest, _radius = settled(oscillator, method, rest)
    n = oscillator.n_modes
    weight = np.concatenate([oscillator.model.omega, np.ones(n)])
    place = np.concatenate([at_rest.displacement, at_rest.velocity])
    first = DISTURBANCE * np.abs(weight * place).max()
    start = place + first * np.where(np.arange(2 * n) % 2 == 0, 1.0, -1.0) / weight
    state = State(displacement=start[:n], velocity=start[n:])
    for count in (*LENGTHS, steps):  # what grows fast is seen early, and need not be followed further
        marks = np.unique(np.geomspace(1, count, 400).astype(int))
        try:
            run = simulate(
                oscillator, state, duration=method.step * count, times=method.step * marks, method=method
            )
        except Diverged:
            return math.inf
        moved = np.concatenate([run.displacement, run.velocity], axis=1) - place
        away = np.abs(weight * moved).max(axis=1)
        large = np.flatnonzero(away > GROWTH * first)
        if large.size:
            # the second half of the way: what is there at the start need not be the mode that grows
            late, early = large[0], np.flatnonzero(away > math.sqrt(GROWTH) * first)[0]
            if late > early:
                return float(np.log(away[late] / away[early]) / (marks[late] - marks[early]))
            return float(np.log(away[late] / first) / marks[late])
        if not (len(run.impacts) == 1 and np.isnan(run.impacts.end[0])):
            return math.inf
    half = marks >= steps // 2
    return float(np.polyfit(marks[half], np.log(away[half]), 1)[0])


def grows(oscillator: ImpactOscillator, method: Splitting, rest: np.ndarray, steps: int = STEPS) -> bool:
    """Whether a disturbance of the pressed contact grows."""
    return growth(oscillator, method, rest, steps) > math.log(GROWTH) / steps


def refused(oscillator: ImpactOscillator, rest: np.ndarray, method: Splitting) -> bool:
    """Whether the method, its limit respected, says that its step is too large."""
    try:
        simulate(oscillator, disturbed(rest), duration=40 * method.step, method=method)
    except StepTooLarge:
        return True
    return False


def motion_of(model: ModalModel) -> Any:
    """The numbers of a model as the limits take them."""
    return ImpactOscillator(model=model, stop=Stop(gap=0.0, law=LinearContact(stiffness=1.0))).motion()


def modal_stiffness(model: ModalModel) -> float:
    """k_modal [N/m]."""
    return float(model.omega[0] ** 2 / model.phi[0] ** 2)


def _limit(
    case: str,
    knob: str,
    theory: float,
    fails: Callable[[float], bool],
    bracket: tuple[float, float],
    turned_away: Callable[[float], bool],
    note: str,
) -> Limit:
    """Bisect `fails`, which is tried from `bracket`, and try the refusal on both sides of `theory`."""
    try:
        found: float | None = bisect(fails, *bracket, relative=1e-7)
    except ValueError as error:
        found, note = None, f"{note}; {error}"
    within, beyond = turned_away((1 - SHARE) * theory), turned_away((1 + SHARE) * theory)
    note += f"; {'refused' if within else 'accepted'} {SHARE:.0%} within the theoretical limit, "
    note += f"{'StepTooLarge' if beyond else 'accepted'} {SHARE:.0%} beyond"
    return Limit(
        method=NAME, case=case, knob=knob, theory=theory, measured=found, refused=beyond, note=note
    )


def stiffness_limits(model: ModalModel, counts: tuple[int, ...], order: int) -> list[Limit]:
    """Largest contact stiffness at two steps, with modal damping."""
    limits = []
    many = STEPS if order == 2 else 5 * STEPS
    for n in counts:
        kept = model.truncated(n)
        for angle in (1.0, 2.5):
            step = angle / float(kept.omega[-1])
            free = Splitting(step=step, order=order, beyond_limit=True)
            theory = free.critical_stiffness(motion_of(kept))

            def fails(k: float, m: ModalModel = kept, method: Splitting = free) -> bool:
                oscillator, rest = pressed(m, k)
                return grows(oscillator, method, rest, many)

            def turned_away(k: float, m: ModalModel = kept, method: Splitting = free) -> bool:
                return refused(*pressed(m, k), replace(method, beyond_limit=False))

            # at order 4 the first instability may be a narrow one: its worst place within 5 % is tried
            beyond = theory * (1.0 + np.geomspace(1e-5, 2.0 if order == 2 else 0.05, 400))
            radii = spectral_radius(motion_of(kept), COMPOSITIONS[order], step, beyond)
            worst = int(np.argmax(radii))
            oscillator, rest = pressed(kept, float(beyond[worst]))
            _state, radius = settled(oscillator, free, rest)
            note = "closed form" if order == 2 else "lowest root of det(M + I) or spectral radius above one"
            note += f"; at {beyond[worst] / theory:.5g} times the limit the spectral radius is "
            note += f"{radii[worst]:.5f}, that of the slopes of the motion about its rest {radius:.5f}"
            if abs(radius - radii[worst]) > 1e-3 * radius:
                note += ": an inner kick finds the tip off the stop"
            limits.append(
                _limit(
                    f"order {order}, {n} mode{'s' if n > 1 else ''} in lasting contact, "
                    f"h omega_N = {angle:g}",
                    "contact stiffness [N/m]", theory, fails, (0.5 * theory, float(beyond[worst])),
                    turned_away, note,
                )
            )  # fmt: skip
    return limits


LONGEST = math.pi * (1.0 - 1e-9)
"""Longest h omega_N to which the closed form is used [1]."""


def step_limits(model: ModalModel, factors: tuple[float, ...]) -> list[Limit]:
    """Longest step of order 2 at a given contact stiffness."""
    limits = []
    motion, modal, highest = motion_of(model), modal_stiffness(model), float(model.omega[-1])
    for factor in factors:
        oscillator, rest = pressed(model, factor * modal)

        def excess(x: float, k: float = factor * modal) -> float:
            limit = closed_form_limit(motion, x / highest)
            assert limit is not None
            return math.log(limit / k)

        if excess(LONGEST) > 0.0:
            continue  # with damping soft contacts are borne by every step below pi
        theory = float(brentq(excess, 1e-3, LONGEST, xtol=1e-14))

        def fails(x: float, o: ImpactOscillator = oscillator, r: np.ndarray = rest) -> bool:
            return grows(o, Splitting(step=x / highest, beyond_limit=True), r)

        def turned_away(x: float, o: ImpactOscillator = oscillator, r: np.ndarray = rest) -> bool:
            return refused(o, r, Splitting(step=x / highest))

        limits.append(
            _limit(
                f"order 2, {model.n_modes} modes in lasting contact, k = {factor:g} k_modal",
                "h omega_N [1]", theory, fails, (0.5 * theory, min(2.0 * theory, 3.3)), turned_away,
                "closed form solved for h",
            )
        )  # fmt: skip
    return limits


TONGUE_STIFFNESS = 100.0
"""Contact stiffness over k_modal along which the resonances are followed."""


def _widest(x: np.ndarray, rate: np.ndarray) -> tuple[float, float, float, float] | None:
    """The widest stretch between pi and 6 in which `rate` shows: before it, its top, after it, its rate."""
    shows = (rate > math.log(GROWTH) / STEPS) & (x > math.pi)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], shows, [False]]).astype(int)))
    stretches = [
        (i, j)
        for i, j in zip(edges[::2], edges[1::2], strict=True)
        if 0 < i and j < x.size and x[j] < 6.0
    ]
    if not stretches:
        return None
    i, j = max(stretches, key=lambda pair: pair[1] - pair[0])
    top = i + int(np.argmax(rate[i:j]))
    return float(x[i - 1]), float(x[top]), float(x[j]), float(rate[top])


def tongues(model: ModalModel, quick: bool) -> tuple[list[Limit], dict[str, np.ndarray]]:
    """Order 2 beyond pi at one stiffness: growth over the step with and without damping, and one tongue."""
    highest, k = float(model.omega[-1]), TONGUE_STIFFNESS * modal_stiffness(model)
    fine = np.linspace(3.0, 6.6, 1801 if quick else 7201)
    coarse = np.linspace(3.0, 6.6, 25 if quick else 145)
    arrays: dict[str, np.ndarray] = {"tongue_fine": fine, "tongue_step": coarse}
    limits = []
    for name, kept in (("undamped", replace(model, decay_rate=0.0 * model.decay_rate)), ("damped", model)):
        motion = motion_of(kept)

        def theory_grows(x: float, m: Any = motion) -> bool:
            return float(spectral_radius(m, COMPOSITIONS[2], x / highest, k)) > math.exp(
                math.log(GROWTH) / STEPS
            )

        oscillator, rest = pressed(kept, k)

        def rate(x: float, o: ImpactOscillator = oscillator, r: np.ndarray = rest) -> float:
            return growth(o, Splitting(step=x / highest, beyond_limit=True), r)

        def fails(x: float, o: ImpactOscillator = oscillator, r: np.ndarray = rest) -> bool:
            return grows(o, Splitting(step=x / highest, beyond_limit=True), r)

        def turned_away(x: float, o: ImpactOscillator = oscillator, r: np.ndarray = rest) -> bool:
            return refused(o, r, Splitting(step=x / highest))

        radius = np.array([float(spectral_radius(motion, COMPOSITIONS[2], x / highest, k)) for x in fine])
        arrays[f"tongue_{name}_theory"] = np.log(radius)
        arrays[f"tongue_{name}_rate"] = np.array([rate(float(x)) for x in coarse])
        found = _widest(fine, np.log(radius))
        if found is None:
            continue
        opens, top, closes, growing = found
        for words, outside in (("widest resonance between pi and 6 opens", opens), ("and closes", closes)):
            theory = bisect(theory_grows, outside, top, relative=1e-10)
            limits.append(
                _limit(
                    f"order 2, {model.n_modes} modes, {name}, k = {TONGUE_STIFFNESS:g} k_modal: {words}",
                    "h omega_N [1]", theory, fails, (outside, top), lambda _x: turned_away(top),  # noqa: B023
                    f"spectral radius; growth by up to {growing:.4f} a step at h omega_N = {top:.4f}, where "
                    "the refusal is tried",
                )
            )  # fmt: skip
    return limits, arrays


def hertz_limits(scene: Scene, model: ModalModel) -> list[Limit]:
    """Pressed into a Hertz contact: the tangent stiffness takes the place of k."""
    hertz = hertz_of(scene)
    limits = []
    for order in (2, 4):
        step = 1.0 / float(model.omega[-1])
        free = Splitting(step=step, order=order, beyond_limit=True)
        critical = free.critical_stiffness(motion_of(model))
        depth = (critical / (1.5 * hertz.stiffness)) ** 2

        def fails(d: float, method: Splitting = free) -> bool:
            oscillator, rest, _force = pressed_hertz(model, hertz.stiffness, d)
            return grows(oscillator, method, rest)

        def turned_away(d: float, method: Splitting = free) -> bool:
            oscillator, rest, _force = pressed_hertz(model, hertz.stiffness, d)
            return refused(oscillator, rest, replace(method, beyond_limit=False))

        limits.append(
            _limit(
                f"order {order}, {model.n_modes} modes pressed into a Hertz contact, h omega_N = 1",
                "depth at rest [m]", depth, fails, (0.3 * depth, 4.0 * depth), turned_away,
                "3/2 k d^(1/2) = k_crit at the exact depth of rest"
                + ("" if order == 2 else "; the inner kicks find other depths, and other tangents"),
            )
        )  # fmt: skip
    return limits


SPEED = 0.2
"""Approach speed at which the exact motion just reaches the limit [m/s]: that of an excess near 1 %."""


def met_in_the_contact(scene: Scene, model: ModalModel, quick: bool) -> Limit:
    """Refused in the course of a Hertz contact: a step whose limit the exact motion reaches at `SPEED`."""
    hertz, gap = hertz_of(scene), 1e-3
    oscillator = ImpactOscillator(model=model, stop=Stop(gap=gap, law=hertz))
    one = np.eye(model.n_modes)[0] / model.phi[0]
    arriving = State(displacement=gap * one, velocity=SPEED * one, regime=1)
    length = 2.0 * hertz.contact_time(1.0 / float(model.phi @ model.phi), SPEED)
    times = np.linspace(0.0, length, 4001)
    exact = simulate(oscillator, arriving, duration=length, times=times)
    deepest = float((exact.displacement @ model.phi).max())
    tangent = 1.5 * hertz.stiffness * math.sqrt(deepest - gap)
    motion, highest = motion_of(model), float(model.omega[-1])

    def excess(x: float) -> float:
        limit = closed_form_limit(motion, x / highest)
        assert limit is not None
        return math.log(limit / tangent)

    step = float(brentq(excess, 1e-6, LONGEST, xtol=1e-14)) / highest

    def met(speed: float, part: float) -> bool:
        start = State(displacement=(gap - (2.0 + part) * step * speed) * one, velocity=speed * one)
        try:
            simulate(oscillator, start, duration=length + 4.0 * step, method=Splitting(step=step))
        except StepTooLarge:
            return True
        return False

    parts = np.linspace(0.0, 1.0, 5 if quick else 17)[:-1] + 0.01
    found = np.array(
        [bisect(partial(met, part=float(part)), 0.05 * SPEED, 20.0 * SPEED) for part in parts]
    )
    return Limit(
        method=NAME, case=f"order 2, {model.n_modes} modes meet a Hertz contact, tangent grows meanwhile",
        knob="approach speed [m/s]", theory=None, measured=float(found.min()),
        refused=all(met(1.01 * v, float(part)) for v, part in zip(found, parts, strict=True)),
        note=f"StepTooLarge in the course of the contact, by the phase of the grid from {found.min():.4g} to "
        f"{found.max():.4g} m/s; the exact motion reaches the limit at {SPEED:g} m/s, where the contact of a "
        f"free body of the same mass takes {0.5 * length / step:.2f} steps",
    )  # fmt: skip


PLANE_STEPS = 3000
"""Steps of a march in the plane: growth by less than ln(1e5)/3000 = 0.4 % a step is not seen there."""


def plane(model: ModalModel, order: int, quick: bool) -> dict[str, np.ndarray]:
    """Growth per step over the plane of stiffness and step, measured and by the spectral radius."""
    modal, highest, motion = modal_stiffness(model), float(model.omega[-1]), motion_of(model)
    steps, stiffness = np.linspace(0.1, 7.0, 8 if quick else 32), np.geomspace(1e-1, 1e6, 8 if quick else 36)
    rate = np.empty((steps.size, stiffness.size))
    for i, x in enumerate(steps):
        method = Splitting(step=float(x) / highest, order=order, beyond_limit=True)
        for j, k in enumerate(stiffness):
            oscillator, rest = pressed(model, float(k) * modal)
            rate[i, j] = growth(oscillator, method, rest, PLANE_STEPS)
    fine_steps = np.linspace(0.1, 7.0, 120 if quick else 460)
    fine_stiffness = np.geomspace(1e-1, 1e6, 140 if quick else 560)
    theory = np.array(
        [
            np.log(spectral_radius(motion, COMPOSITIONS[order], x / highest, fine_stiffness * modal))
            for x in fine_steps
        ]
    )
    line = np.array(
        [Splitting(step=x / highest, order=order).critical_stiffness(motion) / modal for x in fine_steps]
    )
    named = {
        "step": steps, "stiffness": stiffness, "rate": rate, "fine_step": fine_steps,
        "fine_stiffness": fine_stiffness, "theory": theory, "limit": line,
    }  # fmt: skip
    return {f"order_{order}_{name}": value for name, value in named.items()}


def measure(*, quick: bool, scene: Scene) -> Findings:
    """All limits of splitting on the scene's modes and contact."""
    model = model_of(scene)
    counts = tuple(sorted({min(n, model.n_modes) for n in ((1, 5) if quick else (1, 2, 5, 15))}))
    few = model.truncated(min(5, model.n_modes))
    resonances, lines = tongues(few, quick)
    limits = [
        *stiffness_limits(model, counts, 2),
        *step_limits(few, (1e3,) if quick else (1e3, 1e4, 1e5)),
        *resonances,
        *stiffness_limits(model, counts, 4),
        *hertz_limits(scene, few),
        met_in_the_contact(scene, few, quick),
    ]
    return Findings(limits=limits, arrays={**lines, **plane(few, 2, quick), **plane(few, 4, quick)})


def draw(findings: Findings, record: Any) -> None:
    """The plane of step and contact stiffness for both orders; growth along one stiffness."""
    record.write_figure(draw_planes(findings.arrays), "splitting_planes")
    record.write_figure(draw_tongues(findings.arrays), "splitting_resonances")
