"""Limits of splitting in a pressed contact: the motion against the closed form and the spectral radius."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from beam import ModalModel
from contact.integrators.splitting import COMPOSITIONS, Splitting
from contact.integrators.splitting_limit import spectral_radius
from studies.instruments.figures import save
from studies.instruments.scene import Scene
from studies.instruments.stability import splitting_limits as study
from studies.instruments.stability.findings import Findings
from studies.instruments.stability.pressed_contact import pressed
from studies.instruments.stability.splitting_figures import draw_planes, draw_tongues

MODEL = ModalModel(
    omega=[154.0, 960.0, 2450.0], decay_rate=[3.56, 20.0, 55.0], phi=[8.0, 4.7, 3.6],
    participation=[0.1, 0.05, 0.03],
)  # fmt: skip


@pytest.mark.parametrize("order", [2, 4])
def test_a_settled_tip_stays_and_its_slopes_are_the_step_matrix(order):
    step = 1.0 / MODEL.omega[-1]
    method = Splitting(step=step, order=order)
    stiffness = 0.3 * method.critical_stiffness(study.motion_of(MODEL))
    oscillator, rest = pressed(MODEL, stiffness)
    state, radius = study.settled(oscillator, method, rest)
    x = np.concatenate([state.displacement, state.velocity])
    after = study._after(oscillator, method, x)
    weight = np.concatenate([MODEL.omega, np.ones(3)])
    assert weight * after == pytest.approx(weight * x, abs=1e-10 * np.abs(weight * x).max())
    far = np.abs(state.displacement - rest).max() / np.abs(rest).max()
    assert 1e-5 < far < 1.0  # it is not the rest position, but near
    exact = spectral_radius(oscillator.motion(), COMPOSITIONS[order], step, stiffness)
    assert radius == pytest.approx(float(exact), abs=1e-6)


def test_order_2_fails_where_the_closed_form_says():
    limits = study.stiffness_limits(MODEL, (1, 3), 2)
    assert len(limits) == 4
    for limit in limits:
        assert limit.measured == pytest.approx(limit.theory, rel=2e-4)
        assert limit.refused is True
        assert "accepted 1% within" in limit.note and "StepTooLarge 1% beyond" in limit.note


def test_the_longest_step_is_where_the_closed_form_says():
    (limit,) = study.step_limits(MODEL, (100.0,))
    assert limit.measured == pytest.approx(limit.theory, rel=1e-4)
    assert limit.theory < math.pi and limit.refused is True


def test_order_4_fails_where_the_determinant_says():
    """A contact soft enough that every inner kick finds it closed."""
    model = replace(MODEL.truncated(1), decay_rate=np.zeros(1))
    step = 1.0 / model.omega[0]
    method = Splitting(step=step, order=4, beyond_limit=True)
    limit = method.critical_stiffness(study.motion_of(model))
    parts = 1.0 + np.linspace(0.0, 0.05, 4000)
    radii = spectral_radius(study.motion_of(model), COMPOSITIONS[4], step, parts * limit)
    inside = parts[radii > 1 + 1e-7]
    assert inside.max() < 1.04  # the resonance is narrow, and stable contacts lie behind it
    rates = []
    for part in (0.999, float(parts[np.argmax(radii)]), float(inside.max()) + 0.002):
        oscillator, rest = pressed(model, part * limit)
        radius = float(spectral_radius(oscillator.motion(), COMPOSITIONS[4], step, part * limit))
        rates.append((study.growth(oscillator, method, rest, 60_000), math.log(radius)))
    (below, _), (within, theory), (behind, settled) = rates
    assert abs(below) < 1e-4 and abs(behind) < 1e-4 and settled < 1e-7
    assert theory > 2e-4 and within == pytest.approx(theory, rel=0.1)


def test_a_resonance_grows_as_the_spectral_radius_says():
    """Two modes at one stiffness beyond h omega = pi, undamped: growing inside, bounded on both sides."""
    model = replace(MODEL.truncated(2), decay_rate=np.zeros(2))
    highest, k = float(model.omega[-1]), 3.0 * study.modal_stiffness(model)
    fine = np.linspace(3.2, 5.9, 2000)
    motion = study.motion_of(model)
    rate = np.log([float(spectral_radius(motion, COMPOSITIONS[2], x / highest, k)) for x in fine])
    found = study._widest(fine, rate)
    assert found is not None
    opens, top, closes, growing = found
    oscillator, rest = pressed(model, k)

    def measured(x: float) -> float:
        return study.growth(oscillator, Splitting(step=x / highest, beyond_limit=True), rest)

    assert measured(top) == pytest.approx(growing, rel=0.02)
    assert measured(opens - 0.02) < 2e-4 and measured(closes + 0.02) < 2e-4
    assert study.refused(oscillator, rest, Splitting(step=top / highest))


@pytest.fixture(scope="module")
def small_planes() -> dict[str, np.ndarray]:
    model = MODEL.truncated(2)
    return {**study.plane(model, 2, True), **study.plane(model, 4, True)}


@pytest.mark.parametrize("order", [2, 4])
def test_the_motion_in_the_plane_agrees_with_theory(small_planes, order):
    """All 64 points at order 2; at order 4 but for a few where an inner kick finds the tip off the stop."""
    get = {name: small_planes[f"order_{order}_{name}"] for name in ("step", "stiffness", "rate")}
    motion, highest = study.motion_of(MODEL.truncated(2)), float(MODEL.omega[1])
    wrong = 0
    for i, x in enumerate(get["step"]):
        k = get["stiffness"] * study.modal_stiffness(MODEL)
        theory = np.log(spectral_radius(motion, COMPOSITIONS[order], x / highest, k))
        seen = math.log(study.GROWTH) / study.PLANE_STEPS
        clear = np.abs(theory - seen) > 0.5 * seen
        wrong += np.count_nonzero(((get["rate"][i] > seen) != (theory > seen)) & clear)
    assert wrong <= (0 if order == 2 else 4)
    assert 10 < np.count_nonzero(get["rate"] > seen) < 54


def test_the_figures_are_drawn(small_planes, tmp_path):
    x = np.linspace(3.0, 6.6, 30)
    rate = np.where(np.abs(x - 5.0) < 0.2, 0.05, 1e-6)
    lines = {"tongue_fine": x, "tongue_step": x}
    for name in ("undamped", "damped"):
        lines |= {f"tongue_{name}_theory": rate, f"tongue_{name}_rate": rate}
    for figure, name in ((draw_planes(small_planes), "planes"), (draw_tongues(lines), "lines")):
        for path in save(figure, tmp_path, name):
            assert path.stat().st_size > 5000


@pytest.mark.slow
def test_the_whole_family_on_the_scene(tmp_path):
    findings = study.measure(quick=True, scene=Scene())
    assert isinstance(findings, Findings)
    second = [limit for limit in findings.limits if limit.case.startswith("order 2")]
    assert len(second) >= 8
    for limit in second:
        assert limit.refused is True and limit.measured is not None
        assert limit.theory is None or limit.measured == pytest.approx(limit.theory, rel=2e-4)

    class Folder:
        written: list[Path] = []  # noqa: RUF012

        def write_figure(self, figure: object, name: str) -> None:
            self.written.extend(save(figure, tmp_path, name))

    study.draw(findings, Folder())
    assert len(Folder.written) == 4
