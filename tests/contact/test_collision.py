"""Restitution, delay, kick and shift of a collision: planted ones come back, energy is accounted for."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import oscillators
import pytest
from oscillators import GAP, OMEGA
from scipy.optimize import brentq

from beam import ModalModel, UniformBeam, exact_modes
from contact.collision import Collision, before_collision, collisions, first_collision
from contact.drive import HarmonicDrive
from contact.laws import (
    ContactLaw,
    DelayedRestitution,
    HertzContact,
    HuntCrossley,
    LinearContact,
    NewtonRestitution,
)
from contact.oscillator import ImpactOscillator
from contact.simulation import simulate
from contact.stop import Stop
from contact.trajectory import Impacts, State
from studies.scene import beam_at, read_scene

PHI = 10.0 * np.array([1.0, 0.9, 0.8, 0.7, 0.6, 0.5])


def real_differs(collision: Collision) -> bool:
    """Whether real and virtual approach speed differ by more than 1 %."""
    return not abs(collision.real_approach / collision.approach - 1.0) <= 0.01


def spring(
    n_modes: int,
    law: ContactLaw,
    *,
    excess: float | None = 0.05,
    damping: float = 0.02,
    frequency: float = 21.5,
) -> ImpactOscillator:
    """The first modes of a spring of 24.5 Hz with a light tip; undriven if `excess` is None."""
    if excess is None:
        return oscillators.spring(n_modes, law, damping=damping, phi=PHI)
    driven = oscillators.spring(n_modes, law, damping=damping, phi=PHI, drive=(frequency, 0.0))
    return driven.with_excess(excess)


def equation_1(frequency: float, law: ContactLaw, excess: float) -> ImpactOscillator:
    return oscillators.equation_1(frequency, law, gap=0.0107, excess=excess)


def newton(e: float) -> NewtonRestitution:
    return NewtonRestitution(local_restitution=e)


def steady(oscillator: ImpactOscillator, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Modal displacement and velocity of the motion without wall."""
    if oscillator.drive is None:
        return np.zeros(oscillator.n_modes), np.zeros(oscillator.n_modes)
    w = oscillator.drive.angular_frequency
    turning = oscillator.drive.amplitude * oscillator.steady_response() * np.exp(1j * w * time)
    return turning.imag, (1j * w * turning).imag


def flow(oscillator: ImpactOscillator, u: float, v: float, span: float, k: int = 0) -> tuple[float, float]:
    """Free displacement and velocity of under-damped mode k after `span`, by its complex eigenvalue."""
    half = 0.5 * float(oscillator.model.decay_rate[k])
    pole = complex(-half, math.sqrt(float(oscillator.model.omega[k]) ** 2 - half**2))
    c = (v - pole.conjugate() * u) / (2j * pole.imag)  # u = 2 Re(c), v = 2 Re(pole c)
    turned = c * np.exp(pole * span)
    return 2 * turned.real, 2 * (pole * turned).real


# ------------------------------------------------------------------------ planted restitution and delay


@pytest.mark.parametrize("frequency", [20.90, 22.20, 23.40])
@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.3, 0.7, 1.0])
def test_equation_1_has_its_own_restitution_and_no_delay(frequency: float, restitution: float) -> None:
    for excess in (1e-5, 1e-4, 1e-3, 1e-2, 5e-2):
        found = first_collision(equation_1(frequency, newton(restitution), excess))
        speed = 2 * math.pi * frequency * 0.0107 * math.sqrt(excess * (2 + excess))
        assert found.approach == pytest.approx(speed, rel=1e-9)
        assert found.real_approach == pytest.approx(speed, rel=1e-9)
        assert abs(found.restitution - restitution) < 1e-10
        assert abs(found.delay) < 1e-13
        assert abs(found.kick - 1 - restitution) < 1e-10
        assert abs(found.shift) < 1e-16
        assert found.impacts == 1 and found.returns and not found.forced_by_ringing
        assert not real_differs(found)
        assert found.energy_lost == pytest.approx(0.5 * (1 - restitution**2) * speed**2, rel=1e-8, abs=1e-18)
        assert found.energy_to_higher_modes == 0 and found.ringing == 0
        assert found.deceleration == pytest.approx((2 * math.pi * frequency) ** 2 * 0.0107, rel=1e-12)


@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("delay", [0.0, 1e-5, 3e-4, 2e-3])
def test_planted_restitution_and_delay_are_given_back(restitution: float, delay: float) -> None:
    for frequency in (20.90, 23.05):
        for excess in (1e-5, 1e-3, 1e-2, 5e-2):
            law = DelayedRestitution(restitution=restitution, delay=delay)
            found = first_collision(equation_1(frequency, law, excess))
            assert abs(found.restitution - restitution) < 2e-10
            assert abs(found.delay - delay) < 1e-13
            assert found.contact_time == pytest.approx(delay, abs=1e-16)
            # the wait is a kick and a shift of mode 1, to the order of delay x frequency
            speed, a = found.approach, found.deceleration
            off = 0.15 * delay * 2 * math.pi * frequency * (1 + delay * a / speed)
            assert abs(found.kick - 1 - restitution + delay * a / speed) < off + 1e-9


def test_planted_functions_of_the_speed_are_given_back() -> None:
    def restitution(v: float) -> float:
        return 0.15 + 0.5 / (1 + 20 * v)

    def delay(v: float) -> float:
        return 2e-4 * (0.1 + v) ** -0.2

    law = DelayedRestitution(restitution=restitution, delay=delay)
    seen = []
    for excess in (1e-5, 1e-4, 1e-3, 1e-2, 5e-2):
        found = first_collision(equation_1(22.2, law, excess))
        assert found.restitution == pytest.approx(restitution(found.approach), abs=2e-9)
        assert found.delay == pytest.approx(delay(found.approach), abs=1e-12)
        seen.append(found.restitution)
    assert seen[0] > seen[-1] + 0.3


def test_every_collision_of_a_long_run_gives_the_planted_numbers() -> None:
    law = DelayedRestitution(restitution=0.25, delay=2e-4)
    oscillator = equation_1(21.5, law, 0.02)
    run = simulate(oscillator, periods=400)
    found = collisions(oscillator, run, unfinished="drop")
    assert len(found) > 40 and np.ptp([c.approach for c in found]) > 0.05
    for c in found:
        # (rounding of the gap) / (height of the hump of the outgoing motion)
        assert abs(c.restitution - 0.25) < 1e-9 and abs(c.delay - 2e-4) < 1e-12


# ------------------------------------------------------------------------------ Newton's law on several modes

SHARES = {
    0.1: [1, 0.634, 0.419, 0.351, 0.320, 0.295],
    0.3: [1, 0.768, 0.634, 0.592, 0.573, 0.557],
    1.0: [1, 0.900, 0.842, 0.824, 0.816, 0.809],
}
"""r_N for N = 1, 2, 5, 10, 20, 100 modes of a cantilever, for each ratio of tip mass to beam mass."""


def cantilever(ratio: float, count: int) -> ModalModel:
    beam = UniformBeam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0, tip_mass=ratio)
    modes = exact_modes(beam, count)
    scale = 2 * math.pi * 24.5 / modes.omega[0]
    return ModalModel(
        omega=scale * modes.omega, decay_rate=0.01 * scale * modes.omega, phi=modes.phi,
        participation=modes.participation,
    )  # fmt: skip


@pytest.mark.parametrize("ratio", SHARES)
def test_kick_of_one_newton_impact_is_the_share_of_mode_1(ratio: float) -> None:
    """(1 + e) phi_1^2 / sum phi_k^2 with the higher modes at rest, and r_N as tabulated."""
    whole = cantilever(ratio, 100)
    seen = 0
    for count, tabulated in zip((1, 2, 5, 10, 20, 100), SHARES[ratio], strict=True):
        model = whole.truncated(count)
        share = float(model.phi[0] ** 2 / np.sum(model.phi**2))
        assert share == pytest.approx(tabulated, abs=6e-4)
        if count > 20:
            continue
        for e in (0.0, 0.4, 1.0):
            oscillator = ImpactOscillator(
                model=model, stop=Stop(gap=0.01, law=newton(e)), drive=HarmonicDrive(frequency=21.5)
            ).with_excess(0.02)
            found = first_collision(oscillator)
            if found.impacts > 1:
                continue
            seen += 1
            assert found.kick == pytest.approx((1 + e) * share, rel=1e-10)
            assert abs(found.shift) < 1e-15 and found.ringing < 1e-15
            assert abs(found.first_touch - found.time) < 1e-15
            assert not real_differs(found)
            # what does not stay in mode 1 is in the others or lost
            assert found.energy_lost == pytest.approx(
                0.5 * (1 - e * e) * found.approach**2 / np.sum(model.phi**2), rel=1e-10, abs=1e-18
            )
    assert seen >= 8


@pytest.mark.parametrize("e", [0.3, 0.6, 0.8])
def test_several_impacts_of_a_collision_are_one_kick(e: float) -> None:
    """Mode 1 gets the sum of the impulses, each carried back to t_in by its own free flow."""
    oscillator = spring(6, newton(e), damping=0.01)
    run = simulate(oscillator, before_collision(oscillator), periods=60)
    found = collisions(oscillator, run, unfinished="drop")
    impacts = run.impacts
    assert np.all(impacts.kind == 0)  # a stay on the wall would push too
    compliance = float(np.sum(PHI**2))
    several = position = 0
    for c in found:
        rows = np.arange(position, position + c.impacts)
        position += c.impacts
        assert impacts.start[rows[0]] == c.first_touch and impacts.end[rows[-1]] == c.end
        u = v = 0.0
        for i in rows:
            du, dv = flow(oscillator, 0.0, -PHI[0] * (1 + e) * impacts.approach[i] / compliance,
                          c.time - impacts.start[i])  # fmt: skip
            u, v = u + du, v + dv
        assert PHI[0] * u == pytest.approx(c.shift, rel=1e-8, abs=1e-13)
        assert -PHI[0] * v == pytest.approx(c.kick_velocity, rel=1e-9)
        assert c.energy_lost == pytest.approx(
            0.5 * (1 - e * e) * np.sum(impacts.approach[rows] ** 2) / compliance, rel=1e-12
        )
        several += c.impacts > 1
    assert several >= 1


# ------------------------------------------------------------------------------ each number by its definition


@pytest.mark.parametrize(
    "n_modes, law, frequency",
    [(6, newton(0.3), 21.5), (3, newton(0.8), 21.5), (6, HertzContact(stiffness=3e7), 21.5),
     (6, LinearContact(stiffness=3e4), 21.5), (4, HuntCrossley(stiffness=3e7, dissipation=2.0), 21.5),
     (2, newton(1.0), 21.5), (2, newton(1.0), 12.0)],
    ids=repr,
)  # fmt: skip
def test_every_number_is_what_its_definition_says(n_modes: int, law: ContactLaw, frequency: float) -> None:
    """The virtual motions by complex exponentials on a fine grid, collision by collision of a long run.

    At 12 Hz, near half the frequency of mode 1, they have two humps in a drive period.
    """
    excess = 0.05 if frequency > 20 else 0.8
    oscillator = spring(n_modes, law, damping=0.01, frequency=frequency, excess=excess)
    run = simulate(oscillator, before_collision(oscillator), periods=60)
    found = collisions(oscillator, run, unfinished="drop")
    impacts, phi, period = run.impacts, float(oscillator.model.phi[0]), oscillator.period
    assert len(found) > 20
    returned = refused = 0
    for c in found:
        rows = np.flatnonzero((impacts.start >= c.first_touch) & (impacts.end <= c.end) & (impacts.kind != 1))
        first, last = rows[0], rows[-1]

        def virtual(time, at, displacement, velocity, oscillator=oscillator):
            q, rate = steady(oscillator, at)
            u, v = flow(oscillator, displacement[0] - q[0], velocity[0] - rate[0], time - at)
            w, tip = oscillator.drive.angular_frequency, oscillator.model.phi
            size = oscillator.drive.amplitude * (tip @ oscillator.steady_response())
            turning = size * np.exp(1j * w * time)
            return turning.imag + tip[0] * u - GAP, (1j * w * turning).imag + tip[0] * v

        def incoming(time, virtual=virtual, i=first):
            return virtual(time, impacts.start[i], impacts.displacement_start[i], impacts.velocity_start[i])

        def outgoing(time, virtual=virtual, i=last):
            return virtual(time, impacts.end[i], impacts.displacement_end[i], impacts.velocity_end[i])

        def hump(motion, near):
            grid = near + np.linspace(-0.6, 0.6, 241) * period
            speed = motion(grid)[1]
            tops = [brentq(lambda t: motion(t)[1], grid[i], grid[i + 1], xtol=1e-16)
                    for i in np.flatnonzero((speed[:-1] > 0) & (speed[1:] <= 0))]  # fmt: skip
            return min(tops, key=lambda t: abs(t - near))

        def sides(motion, near):
            top = hump(motion, near)
            if motion(top)[0] <= 0:
                return None
            out = []
            for side in (-1, 1):
                far = top
                while motion(far)[0] > 0:
                    far += side * 0.002 * period
                out.append(
                    brentq(lambda t: motion(t)[0], min(far, top), max(far, top), xtol=1e-17, rtol=1e-15)
                )
            return out

        touched = sides(incoming, c.first_touch)
        assert c.forced_by_ringing == (touched is None)
        t_in = c.first_touch if touched is None else touched[0]
        assert c.time == pytest.approx(t_in, abs=1e-12)
        v_in = incoming(t_in)[1]
        jump = np.subtract(outgoing(t_in), incoming(t_in))
        assert c.shift == pytest.approx(jump[0], abs=1e-13)
        assert c.kick_velocity == pytest.approx(-jump[1], abs=1e-11)
        left = sides(outgoing, t_in)
        assert c.returns == (left is not None)
        if c.forced_by_ringing:
            assert math.isnan(c.approach) and math.isnan(c.kick)
        else:
            assert c.approach == pytest.approx(v_in, rel=1e-10)
            assert c.kick == pytest.approx(-jump[1] / v_in, abs=1e-8)
        if touched is None or left is None:
            refused += 1
            assert math.isnan(c.restitution) and math.isnan(c.delay)
        else:
            returned += 1
            # rounding moves the sides of a low hump: times and speeds there lose up to half their digits
            height = min(incoming(hump(incoming, c.first_touch))[0], outgoing(hump(outgoing, t_in))[0])
            slack = 1e-15 * math.sqrt(GAP / height)
            assert c.delay == pytest.approx(left[1] - t_in, abs=20 * slack)
            assert c.restitution == pytest.approx(-outgoing(left[1])[1] / v_in, abs=1e4 * slack)
        gain = 0.0
        before, after = steady(oscillator, impacts.start[first]), steady(oscillator, impacts.end[last])
        for k in range(1, n_modes):
            u, v = flow(
                oscillator, impacts.displacement_start[first, k] - before[0][k],
                impacts.velocity_start[first, k] - before[1][k], c.end - c.first_touch, k,
            )  # fmt: skip
            q = impacts.displacement_end[last, k] - after[0][k]
            rate = impacts.velocity_end[last, k] - after[1][k]
            gain += 0.5 * (rate**2 - v**2 + OMEGA[k] ** 2 * (q**2 - u**2))
        assert c.energy_to_higher_modes == pytest.approx(gain, abs=1e-11 * (OMEGA[0] * GAP) ** 2)
        real = abs(impacts.approach[first] / v_in - 1) > 0.01 if touched is not None else True
        assert real_differs(c) == real and c.real_approach == impacts.approach[first]
        assert c.contact_time == pytest.approx(float(np.sum((impacts.end - impacts.start)[rows])), abs=1e-15)
        assert phi == 10.0
        slopes = [incoming(t_in + h)[1] for h in (-1e-6, 1e-6)]
        assert c.deceleration == pytest.approx(-(slopes[1] - slopes[0]) / 2e-6, rel=1e-5)
    assert returned > 3 and returned + refused == len(found)


@pytest.mark.parametrize("before_minimum", [1e-3, 1e-6, -1e-6, -1e-3])
def test_minimum_of_the_outgoing_motion_ends_a_collision(before_minimum: float) -> None:
    """A second touch, made up to change nothing, counts to the first until the minimum and no longer."""
    oscillator = ImpactOscillator(
        model=ModalModel(omega=[2 * math.pi], decay_rate=[0.0], phi=[1.0], participation=[0.0]),
        stop=Stop(gap=0.0, law=newton(0.5)),
    )
    # swinging through the wall at t = 1 with velocity 1, out with 1/2: minimum a quarter period later
    real = simulate(oscillator, State(displacement=[0.0], velocity=[-1.0], time=0.5), duration=2.2)
    assert real.impacts.start[0] == pytest.approx(1.0, abs=1e-15)
    second = 1.25 - before_minimum
    angle = 2 * math.pi * (second - 1.0)
    state = np.array([[-math.sin(angle) / (4 * math.pi)]]), np.array([[-0.5 * math.cos(angle)]])
    rows = {name: getattr(real.impacts, name)[:1] for name in real.impacts.__dataclass_fields__}
    made_up = dict(start=second, end=second, approach=0.0, rebound=0.0, loss=0.0, kind=0)
    for name, value in made_up.items():
        rows[name] = np.append(rows[name], value).astype(rows[name].dtype)
    for i, name in enumerate(("displacement", "velocity")):
        for end in ("start", "end"):
            rows[f"{name}_{end}"] = np.vstack([rows[f"{name}_{end}"], state[i]])
    found = collisions(oscillator, dataclasses.replace(real, impacts=Impacts(**rows)), unfinished="drop")
    assert [c.impacts for c in found] == ([2] if before_minimum > 0 else [1, 1])
    assert found[0].kick == pytest.approx(1.5, rel=1e-12)
    assert found[0].restitution == pytest.approx(0.5, rel=1e-12)


def test_each_impact_belongs_to_one_collision() -> None:
    """A collision ends with a minimum of its outgoing virtual motion, and no impact comes before that."""
    several = 0
    for law in (newton(0.0), newton(0.3), newton(0.8), LinearContact(stiffness=1e6, damping=3.0)):
        oscillator = spring(6, law, damping=0.01)
        run = simulate(oscillator, before_collision(oscillator), periods=60)
        found = collisions(oscillator, run, unfinished="drop")
        impacts = run.impacts
        starts = impacts.start[impacts.kind == 0]
        counted = np.sum([c.impacts for c in found])
        assert starts.size - 8 <= counted <= starts.size and len(found) > 20
        several += counted - len(found)
        edges = np.searchsorted(starts, [c.first_touch for c in found])
        np.testing.assert_array_equal(np.diff(edges), [c.impacts for c in found[:-1]])
        for c, following in itertools.pairwise(found):
            last = int(np.flatnonzero(impacts.end == c.end)[-1])
            q, rate = steady(oscillator, c.end)
            u = impacts.displacement_end[last, 0] - q[0]
            v = impacts.velocity_end[last, 0] - rate[0]

            def speed(time, c=c, u=u, v=v, oscillator=oscillator):
                return PHI @ steady(oscillator, time)[1] + PHI[0] * flow(oscillator, u, v, time - c.end)[1]

            ahead = np.array([speed(t) for t in np.linspace(c.end, following.first_touch, 400)])
            assert np.any((ahead[:-1] < 0) & (ahead[1:] >= 0))
            assert c.end - c.first_touch < 0.9 * oscillator.period
    assert several > 20


# --------------------------------------------------------------------------- relations between the numbers


@pytest.fixture(scope="module")
def letter_with_hertz() -> ImpactOscillator:
    return beam_at(read_scene("letter", ['contact.law="hertz"']), 22.2)


@pytest.mark.parametrize("frequency", [20.90, 22.20, 23.40])
def test_two_relations_of_a_single_contact_of_the_letters_spring(
    frequency: float, letter_with_hertz: ImpactOscillator
) -> None:
    """restitution^2 = (1 - kick)^2 + 2 a shift/v^2, delay = (v/a)(1 + restitution - kick), within 3e-3."""
    oscillator = dataclasses.replace(letter_with_hertz, drive=HarmonicDrive(frequency=frequency))
    kicks, restitutions = [], []
    for excess in (1e-5, 1e-4, 1e-3, 5e-3, 1.3e-2, 3e-2, 5e-2):
        c = first_collision(oscillator.with_excess(excess))
        assert c.impacts == 1 and c.returns and not c.forced_by_ringing
        a, v = c.deceleration, c.approach
        assert a == pytest.approx((2 * math.pi * frequency) ** 2 * oscillator.stop.gap, rel=1e-9)
        assert abs(c.restitution**2 - (1 - c.kick) ** 2 - 2 * a * c.shift / v**2) < 3e-3
        assert abs(c.delay * a / v - (1 + c.restitution - c.kick)) < 3e-3
        # shift = kick v t_c / 2 to the same order: the contact acts at its middle
        assert c.restitution**2 == pytest.approx(
            (1 - c.kick) ** 2 + c.kick * c.contact_time * a / v, abs=6e-3
        )
        kicks.append(c.kick)
        restitutions.append(c.restitution)
    # slow approaches are not kicked at all, and the kick rises with the speed
    assert kicks[0] < 0.15 and restitutions[0] > 0.98
    assert np.all(np.diff(kicks) > 0) and kicks[-1] > 1
    assert np.all(np.diff(restitutions) < 0)


def test_leading_order_relations_are_those_of_a_parabola() -> None:
    """The shorter its arc, the better a planted collision fulfils both relations."""
    errors = []
    for scale in (1.0, 0.5, 0.25, 0.125):
        law = DelayedRestitution(restitution=0.4, delay=4e-4 * scale)
        c = first_collision(equation_1(22.2, law, 2e-2 * scale**2))
        a, v = c.deceleration, c.approach
        errors.append([
            abs(c.restitution**2 - (1 - c.kick) ** 2 - 2 * a * c.shift / v**2),
            abs(c.delay * a / v - (1 + c.restitution - c.kick)),
        ])  # fmt: skip
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert np.all(ratios > 1.7) and np.all(ratios < 5)
    assert np.max(errors[-1]) < 3e-3


# ------------------------------------------------------------------------------------------- energy


def change_of_mode_1(c: Collision, oscillator: ImpactOscillator) -> float:
    """Energy gained by the free motion of mode 1, from the collision's own numbers at t_in [J]."""
    phi, omega = float(oscillator.model.phi[0]), float(oscillator.model.omega[0])
    q, rate = steady(oscillator, c.time)
    x = oscillator.stop.gap - float(oscillator.model.phi @ q)
    v = c.approach - float(oscillator.model.phi @ rate)
    after = (v - c.kick_velocity) ** 2 + omega**2 * (x + c.shift) ** 2
    return 0.5 * (after - v**2 - (omega * x) ** 2) / phi**2


LOSSES = [
    newton(0.0), newton(0.5), newton(1.0), HertzContact(stiffness=3e7),
    HuntCrossley(stiffness=3e7, dissipation=2.0), LinearContact(stiffness=3e4),
    LinearContact(stiffness=3e5, damping=10.0),
]  # fmt: skip


@pytest.mark.parametrize("law", LOSSES, ids=repr)
@pytest.mark.parametrize("n_modes", [1, 2, 6])
def test_energy_of_an_undriven_collision_is_all_accounted_for(n_modes: int, law: ContactLaw) -> None:
    """Without drive and damping: gain of mode 1 + gain of the higher modes + loss = 0, time and again."""
    oscillator = spring(n_modes, law, excess=None, damping=0.0)
    start = np.zeros(n_modes)
    start[0] = -0.0009
    state = State(displacement=start, velocity=np.zeros(n_modes))
    first = float(oscillator.energy(state.displacement, state.velocity))
    found = collisions(oscillator, simulate(oscillator, state, duration=0.4), unfinished="drop")
    used = [c for c in found if not c.forced_by_ringing]
    plastic = n_modes == 1 and law == newton(
        0.0
    )  # the one collision leaves nothing that could reach the wall
    assert len(used) >= (1 if plastic else 3)
    for c in used:
        total = change_of_mode_1(c, oscillator) + c.energy_to_higher_modes + c.energy_lost
        assert abs(total) < 1e-11 * first
    lossless = law in (newton(1.0), HertzContact(stiffness=3e7), LinearContact(stiffness=3e4))
    assert (abs(used[0].energy_lost) < 1e-13 * first) == lossless
    assert (used[0].energy_to_higher_modes > 0.01 * first) == (n_modes > 1)
    assert used[0].ringing < 1e-12 and (used[-1].ringing > 3e-5) == (n_modes > 1)


@pytest.mark.parametrize("law", LOSSES[1:5], ids=repr)
@pytest.mark.parametrize("n_modes", [1, 6])
def test_energy_of_a_driven_collision_is_the_work_of_the_drive(n_modes: int, law: ContactLaw) -> None:
    """The free motion gains what the force does along the steady motion, int N x_s' dt, less the loss."""
    oscillator = spring(n_modes, law, damping=0.0)
    start = before_collision(oscillator)
    c = first_collision(oscillator, start)
    tip = oscillator.model.phi
    run = simulate(oscillator, start, periods=4)
    rows = np.flatnonzero((run.impacts.start <= c.end) & (run.impacts.kind == 0))
    assert rows.size == c.impacts and np.all(run.impacts.kind == 0)
    work = 0.0
    points, weights = np.polynomial.legendre.leggauss(40)
    for i in rows:
        begin, end = run.impacts.start[i], run.impacts.end[i]
        if isinstance(law, NewtonRestitution):
            impulse = (1 + law.local_restitution) * run.impacts.approach[i] / float(tip @ tip)
            work += impulse * float(tip @ steady(oscillator, begin)[1])
            continue
        edges = np.linspace(begin, end, 21)
        times = (0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * points).ravel()
        inside = simulate(oscillator, start, periods=4, times=times)
        depth = np.maximum(inside.displacement @ tip - GAP, 0.0)
        chi = law.dissipation if isinstance(law, HuntCrossley) else 0.0
        force = law.stiffness * depth**1.5 * (1 + chi * inside.velocity @ tip)
        along = np.array([float(tip @ steady(oscillator, t)[1]) for t in times])
        work += 0.5 * (edges[1] - edges[0]) * float(np.tile(weights, 20) @ (force * along))
    total = change_of_mode_1(c, oscillator) + c.energy_to_higher_modes + c.energy_lost
    scale = 0.5 * c.approach**2 / float(tip @ tip)
    assert total == pytest.approx(work, abs=2e-7 * scale)
    # N x_s' is positive while the steady motion goes into the wall
    assert abs(work) > 0.05 * scale


# --------------------------------------------------------------------------- collisions of a special kind


def two_modes(first: float, second: float, e: float, lead: float) -> tuple[ImpactOscillator, State]:
    """Mode 1 of `first` gaps, `lead` [rad] before its peak; mode 2 of `second` gaps, rising through zero."""
    oscillator = spring(2, newton(e), excess=None, damping=0.0)
    amplitude = GAP / PHI[:2] * np.array([first, second])
    return oscillator, State(
        displacement=[amplitude[0] * math.cos(lead), 0.0],
        velocity=[amplitude[0] * OMEGA[0] * math.sin(lead), amplitude[1] * OMEGA[1]],
    )


@pytest.mark.parametrize("second, returns", [(0.056, False), (0.2, True)])
def test_ringing_alone_can_make_the_touch(second: float, returns: bool) -> None:
    """Mode 1 peaks at 0.97 gaps: it would pass by; mode 2 carries the tip into the wall."""
    oscillator, state = two_modes(0.97, second, 0.1, 0.2)
    run = simulate(oscillator, state, duration=0.06)
    c = collisions(oscillator, run, unfinished="drop")[0]
    assert c.forced_by_ringing and real_differs(c) and c.returns == returns and c.impacts == 1
    assert all(math.isnan(x) for x in (c.approach, c.restitution, c.delay, c.kick))
    assert c.time == c.first_touch == run.impacts.start[0]
    assert c.ringing == pytest.approx(second * GAP, rel=1e-12)
    share = 1.1 / (1 + 0.81)
    assert c.kick_velocity == pytest.approx(share * c.real_approach, rel=1e-12)
    assert abs(c.shift) < 1e-17
    # with a little more of mode 1 the same touch is one of its own
    oscillator, state = two_modes(1.001, second, 0.1, 0.2)
    other = collisions(oscillator, simulate(oscillator, state, duration=0.06), unfinished="drop")[0]
    assert not other.forced_by_ringing and other.approach > 0


def test_outgoing_motion_may_stay_below_the_gap() -> None:
    """Touched early by the ringing and turned back at once: kick but neither restitution nor delay."""
    oscillator, state = two_modes(1.01, 0.08, 0.1, 0.4)
    c = collisions(oscillator, simulate(oscillator, state, duration=0.06), unfinished="drop")[0]
    assert not c.forced_by_ringing and not c.returns and c.impacts == 1
    assert math.isnan(c.restitution) and math.isnan(c.delay)
    assert c.first_touch < c.time - 1e-4 and real_differs(c)
    assert c.kick * c.approach == pytest.approx(c.kick_velocity, rel=1e-14) and c.kick > 0.5
    # mode 1 has 1.01 gaps of amplitude before, and less than one after
    after = math.hypot(GAP + c.shift, (c.approach - c.kick_velocity) / OMEGA[0])
    before = math.hypot(GAP, c.approach / OMEGA[0])
    assert before == pytest.approx(1.01 * GAP, rel=1e-12) and after < GAP


def test_collision_that_is_not_final_is_refused_in_a_sentence() -> None:
    oscillator = equation_1(22.2, newton(0.3), 0.01)
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=8)
    touch = float(whole.impacts.start[0])
    final = None
    for after in (1e-5, 0.1 / 22.2, 0.4 / 22.2, 0.6 / 22.2, 0.95 / 22.2):
        run = simulate(oscillator, start, duration=touch - start.time + after)
        assert len(run.impacts) == 1
        try:
            found = collisions(oscillator, run)
        except ValueError as error:
            text = str(error)
            assert text.count(". ") == 0 and "\n" not in text and "before the collision" in text
            assert f"{run.end.time:.6g} s" in text and f"{touch:.6g} s" in text and "longer" in text
            assert collisions(oscillator, run, unfinished="drop") == []
            assert final is None
            continue
        final = after if final is None else final
        assert len(found) == 1
        assert found[0] == collisions(oscillator, whole, unfinished="drop")[0]
    # the next minimum of a motion at about the drive frequency comes half a period later
    assert final == pytest.approx(0.6 / 22.2)
    with pytest.raises(ValueError, match=r'unfinished is .*must be "refuse" or "drop"'):
        collisions(oscillator, whole, unfinished="keep")


def test_contact_under_way_at_the_end_is_no_collision_yet() -> None:
    oscillator = spring(4, HertzContact(stiffness=3e7))
    start = before_collision(oscillator)
    whole = simulate(oscillator, start, periods=4)
    middle = 0.5 * (whole.impacts.start[0] + whole.impacts.end[0])
    run = simulate(oscillator, start, duration=middle - start.time)
    assert len(run.impacts) == 1 and math.isnan(run.impacts.end[0])
    with pytest.raises(ValueError, match="final"):
        collisions(oscillator, run)
    assert collisions(oscillator, run, unfinished="drop") == []
    free = simulate(oscillator, start, duration=0.5 * (whole.impacts.start[0] - start.time))
    assert collisions(oscillator, free) == []


def test_grazes_are_no_collisions() -> None:
    oscillator = equation_1(22.2, newton(0.3), 0.0)
    run = simulate(oscillator, before_collision(oscillator), periods=6)
    assert np.all(run.impacts.kind == 1)
    assert collisions(oscillator, run) == []


# ------------------------------------------------------------------------------------------- invariance

SAME = ["approach", "restitution", "delay", "kick", "kick_velocity", "shift", "deceleration", "contact_time",
        "real_approach", "ringing", "energy_to_higher_modes", "energy_lost"]  # fmt: skip


@pytest.mark.parametrize(
    "law", [HertzContact(stiffness=3e7), LinearContact(stiffness=3e5, damping=10.0), newton(0.4)], ids=repr
)
def test_collision_does_not_depend_on_where_the_motion_is_started(law: ContactLaw) -> None:
    """Started anywhere along the same motion, or whole drive periods later."""
    oscillator = spring(6, law)
    start = before_collision(oscillator)
    run = simulate(oscillator, start, periods=40)
    found = collisions(oscillator, run, unfinished="drop")
    chosen = found[4]
    before = found[3].end
    scale = {"ringing": GAP, "shift": 1e-3, "energy_to_higher_modes": 1e-3, "energy_lost": 1e-3,
             "delay": 1e-2,             "contact_time": 1e-2}  # fmt: skip
    times = before + np.array([0.05, 0.3, 0.6, 0.95, 0.9999]) * (chosen.first_touch - before)
    along = simulate(oscillator, start, periods=40, times=times)
    for i, later in ((0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (2, 1), (2, 1000), (4, 100_000)):
        state = State(
            displacement=along.displacement[i],
            velocity=along.velocity[i],
            time=times[i] + later * oscillator.period,
        )
        again = first_collision(oscillator, state)
        assert again.impacts == chosen.impacts and again.returns == chosen.returns
        shift = later * oscillator.period
        loose = 1 + 3e3 * shift  # rounding of the time, 1e-12 s after 1e5 periods
        assert again.time - shift == pytest.approx(chosen.time, abs=1e-12 * loose)
        for name in SAME:
            mine, theirs = getattr(again, name), getattr(chosen, name)
            if math.isnan(theirs):
                assert math.isnan(mine), name
                continue
            # rounding grows with the ratio of the higher modes' velocities to what mode 1 takes up
            assert mine == pytest.approx(theirs, rel=1e-9 * loose, abs=1e-9 * loose * scale.get(name, 1.0)), (
                name
            )


def test_first_collision_looks_for_one_long_enough_or_says_so() -> None:
    resting = equation_1(23.4, newton(0.3), -0.02)
    from_rest = first_collision(resting, State.rest(1))
    run = simulate(resting, periods=64)
    assert from_rest == collisions(resting, run, unfinished="drop")[0]
    assert from_rest.first_touch > 3 / 23.4  # not within the first try of three periods
    below = equation_1(22.2, newton(0.3), -0.01)
    with pytest.raises(ValueError, match="periods is 64; no collision"):
        first_collision(below)
    with pytest.raises(ValueError, match="periods is 2; no collision"):
        first_collision(resting, State.rest(1), periods=2)
    with pytest.raises(ValueError, match=r"drive is None.*give a state"):
        first_collision(spring(2, newton(0.3), excess=None))


def test_before_collision_is_the_lowest_point_of_the_steady_motion() -> None:
    oscillator = spring(6, newton(0.3))
    state = before_collision(oscillator)
    assert 0 <= state.time < oscillator.period
    q, rate = steady(oscillator, state.time)
    np.testing.assert_allclose(state.displacement, q, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(state.velocity, rate, rtol=1e-10, atol=1e-12)
    assert float(PHI @ state.displacement) == pytest.approx(-1.05 * GAP, rel=1e-12)
    assert abs(float(PHI @ state.velocity)) < 1e-12
