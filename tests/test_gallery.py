"""Examples of the gallery: each runs without a warning and ends with a picture, and its physics is right."""

import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import MagicMock

import matplotlib.pyplot as plt
import numpy as np
import pytest
from pytest import approx
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from contact import HertzContact, NordmarkMap
from contact.orbits import MaximalFamily, onset_m

GALLERY = Path(__file__).parent.parent / "docs" / "gallery"
RENDER = "import pyvista; p = pyvista.Plotter(); p.add_mesh(pyvista.Cube()); p.show()"


def first_graze(found):
    spring, (below, above) = found["spring"], found["motions"].values()
    w, omega, decay = 2 * np.pi * 21.5, *spring.model.omega, *spring.model.decay_rate
    assert spring.grazing_amplitude() == approx(0.0119 * abs(omega**2 - w**2 + 1j * w * decay) / w**2)
    assert len(below.impacts) == 0 and above.strobe_impacts[-12:].tolist() == [1, 0, 0, 0] * 3
    assert above.impacts.approach[0] == approx(w * 0.0119 * np.sqrt(1.001**2 - 1), rel=1e-9)


def p4_and_its_hysteresis(found):
    fold = found["fold"].excess
    assert 0.0 > fold == approx(MaximalFamily(oscillator=found["spring"], m=4).fold().excess, rel=1e-8)
    for scan, limit in ((found["up"], 0.0), (found["down"], fold)):
        assert scan.m.tolist() == np.where(scan.excess > limit, 4, 1).tolist()
        np.testing.assert_allclose(scan.points[:, 4:], scan.points[:, :4], atol=1e-9)


def whole_branch(found):
    """The scan follows the motion in time: it loses the orbit at the fold, and before has the same speeds."""
    branch, seen, step = found["branch"], found["seen"], 0.02 / 40
    fold = branch.of_kind("fold")[0]
    assert seen[-1, 0] - step < fold.excess < seen[-1, 0]
    good = [orbit for orbit in branch.orbits if orbit.stable and orbit.admissible]
    places, speeds = np.transpose([(orbit.excess, 1e3 * orbit.speed) for orbit in [fold, *good]])
    away = seen[seen[:, 0] > 0.8 * fold.excess]  # chords of the curve are too far from it next to the fold
    assert len(away) > 25 and np.interp(away[:, 0], places, speeds) == approx(away[:, 1], rel=0.01)


def modal_test(found):
    model, true, w = found["measured"], found["seen"], 2.0 * np.pi * np.linspace(5.0, 60.0, 99)[:, None]
    responses = [
        (one.phi * one.participation / (one.omega**2 - w**2 + 1j * w * one.decay_rate)).sum(axis=1)
        for one in (model, true)
    ]
    assert np.abs(responses[0] / responses[1] - 1.0).max() < 0.03
    forces = [run.impacts.peak_force.max() for run in found["runs"].values()]
    assert forces[1] == approx(forces[0], rel=0.05)


def one_collision(found):
    hit, tip, outgoing = found["hit"], found["beam"].tip, found["outgoing"]
    late = outgoing.time - hit.time - hit.delay
    assert np.interp(0.0, late, tip(outgoing.displacement)) == approx(0.01188, abs=1e-9)
    leaves = -np.interp(0.0, late, tip(outgoing.velocity))
    assert hit.restitution == approx(leaves / hit.approach, rel=1e-3)
    expected = hit.approach / hit.deceleration * (1.0 + hit.restitution - hit.kick)
    assert hit.delay == approx(expected, rel=0.02)


def fit_a_record(found):
    """What was put in comes out, and the predicted fold is right within the error of the amplitude."""
    bench, one = found["bench"], found["fitted"]
    truth = [0.0402, 3.2, 8.5e-3, bench.drive.amplitude, 0.1, 21.9, 0.0, 0.0]
    assert np.abs((one.estimate - truth) / one.errors).max() < 4.0 and one.record.rows.shape == (2999, 2)
    assert found["predicted"].amplitude == approx(found["true"].amplitude, abs=4.0 * one.errors[3])
    assert one.problem.prediction.m == 4 and one.noise == approx(5e-6, rel=0.05)


def peak_force(found):
    force, least = found["force"], found["gaps"][:, None] / found["amplitudes"]
    assert force.size >= 400 and np.array_equal(force == 0.0, least > found["factor"])


def mode_shapes(found):
    shapes = np.array([*found["shapes"].point_data.values()])
    assert len(shapes) == 6 and np.linalg.norm(shapes, axis=2).max(axis=1) == approx(6e-3)
    sideways = np.abs(shapes[:, -300:, 1]).max(axis=1)  # of the ball, the last points
    assert (sideways > 2e-3).tolist() == found["modes"].coupled.tolist() == [True, False] * 3
    assert sideways[1::2].max() < 1e-9 and len(found["frames"]) == 24


def two_stops(found):
    small, large = found["small"], found["large"]
    assert np.all(np.diff(small.impacts.stop[-40:])) and np.all(np.diff(large.impacts.stop[-40:]))
    assert small.displacement[500:] == approx(-small.displacement[:-500], abs=1e-9)
    assert np.ptp(small.impacts.approach[-2:]) < 1e-9 and np.ptp(large.impacts.approach[-2:]) > 1.0


def contact_laws(found):
    for (hit, _, _), e in zip(found["found"].values(), (0.6, 0.6, 0.6, 1.0), strict=True):
        assert [-hit.rebound[0], hit.loss[0]] == approx([e * 0.3, 18e-5 * (1 - e**2)], abs=1e-12)
    time = HertzContact(stiffness=4.5e-4 / 50e-6**2.5).contact_time(mass=4e-3, velocity=0.3)
    assert found["found"]["Hertz"][0].duration == approx(time, rel=1e-5)


def coming_to_rest(found):
    w, hops, omega = 10 * np.pi, found["hops"], found["model"].omega[0]
    assert 15e-3 * w**2 * np.sin(w * found["leaves"]) == approx(4e-3 * omega**2 - 105, rel=1e-9)
    left = found["impacts"].start[found["after"]] - found["landings"][-1]  # the sum of all further hops
    assert [*hops[-9:], left] == approx([*0.7 * hops[-10:-1], hops[-1] * 0.7 / 0.3], rel=1e-4)


def matrices_of_your_own(found):
    square, V = (part[..., :8] for part in eigh(found["K"].toarray(), found["M"].toarray()))
    points, gaps, w, times = found["points"], (0.5e-3, 0.2e-3), 126 * np.pi, found["times"][:1001]
    rows = np.array([points["roof"], -points["leg"]]) @ V
    base = 4e-4 * w**2 * V.T @ found["M"] @ found["sideways"]

    def rate(t, y):
        push = 1e6 * np.maximum(0, rows @ y[:8] - gaps) @ rows
        return [*y[8:], *(base * np.sin(w * t) - square * (y[:8] + 4e-5 * y[8:]) - push)]

    other = solve_ivp(rate, (0, times[-1]), np.zeros(16), "DOP853", times, rtol=1e-9, atol=1e-12).y[:8]
    ours = found["frame"].heights(found["motion"].displacement[:1001]) + gaps
    assert ours == approx((rows @ other).T, abs=1e-8)


def bands_of_the_map(found):
    for spring, orbit in list(zip(found["springs"], found["orbits"], strict=True))[10::20]:
        m = onset_m(NordmarkMap.from_oscillator(spring))
        assert m in [b.m for b in found["bands"] if b.lower < spring.drive.frequency < b.upper]
        exact = MaximalFamily(oscillator=spring, m=m).orbits(1e-3)
        assert ((orbit.m, orbit.impacts) == (m, 1)) <= any(one.stable and one.admissible for one in exact)


def strange_attractor(found):
    strobed, here, rates = found["strobed"], found["start"], []
    apart = 1e-8 * np.eye(2)[1]
    for _ in range(2000):  # two motions side by side, set back to the same distance at each strobe
        there = replace(here, displacement=here.displacement + apart[0], velocity=here.velocity + apart[1])
        here, there = (strobed.orbit(one, 1).end for one in (here, there))
        apart = np.append(there.displacement - here.displacement, there.velocity - here.velocity)
        rates.append(np.log(1e8 * np.linalg.norm(apart)))
        apart *= 1e-8 / np.linalg.norm(apart)
    assert found["exponents"].largest == approx(np.mean(rates), abs=0.1)


def missed_touches(found):
    model, t = found["model"], np.linspace(0, found["period"], 200_001)[:, None]
    c, w = 0.5 * model.decay_rate, np.sqrt(model.omega**2 - 0.25 * model.decay_rate**2)
    for start, first in list(zip(found["starts"], found["exact"], strict=True))[:6]:
        q, v = start.displacement, start.velocity
        tip = (np.exp(-c * t) * (q * np.cos(w * t) + (v + c * q) / w * np.sin(w * t))) @ model.phi
        assert t[np.argmax(tip > 4e-3), 0] == approx(first, abs=4e-7)


@pytest.mark.parametrize("path", [*GALLERY.glob("*.py")], ids=lambda path: path.stem)
def test_an_example_runs_and_is_right(path, monkeypatch, tmp_path):
    text, shown = path.read_text("utf-8"), []
    assert 20 <= len(text.splitlines()) <= 60
    if "pyvista" in text:
        monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
        monkeypatch.setenv("PYVISTA_OFF_SCREEN", "true")
        monkeypatch.setattr("pyvista.OFF_SCREEN", True)
        if subprocess.run([sys.executable, "-c", RENDER], stderr=subprocess.DEVNULL, timeout=100).returncode:
            monkeypatch.setattr("pyvista.Plotter", MagicMock())  # no graphics library is installed
    plt.switch_backend("agg")
    monkeypatch.setattr(plt, "show", lambda: shown.append(plt.gcf()))
    monkeypatch.chdir(tmp_path)
    found = runpy.run_path(str(path))
    assert shown == [found["figure"]] and not [*tmp_path.iterdir()]
    if "film" in found:
        found["film"].save("film.gif", "pillow")
    found["figure"].canvas.draw()
    image = np.asarray(found["figure"].canvas.buffer_rgba()).min(axis=2)
    assert image[0, 0] == 255 and 0.01 < np.mean(image < 200) < 0.9
    plt.close("all")
    globals()[path.stem](found)
