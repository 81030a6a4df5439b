"""Examples of the gallery: each runs without a warning and ends with a picture, and its physics is right."""

import runpy
import subprocess
import sys
from pathlib import Path
from unittest.mock import MagicMock

import matplotlib.pyplot as plt
import numpy as np
import pytest
from pytest import approx

from contact.orbits import MaximalFamily

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


def one_collision(found):
    hit, tip, outgoing = found["hit"], found["beam"].tip, found["outgoing"]
    late = outgoing.time - hit.time - hit.delay
    assert np.interp(0.0, late, tip(outgoing.displacement)) == approx(0.01188, abs=1e-9)
    leaves = -np.interp(0.0, late, tip(outgoing.velocity))
    assert 0.0 < hit.restitution < 1.0 and hit.restitution == approx(leaves / hit.approach, rel=1e-3)
    expected = hit.approach / hit.deceleration * (1.0 + hit.restitution - hit.kick)
    assert hit.delay == approx(expected, rel=0.02)


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
    for name, (impacts, depth, _) in found["found"].items():
        e = 1.0 if name == "Hertz" else 0.6
        assert [depth.max(), -impacts.rebound[0]] == approx([50e-6, e * 0.3], rel=1e-6)
        assert impacts.loss[0] == approx(0.5 * 4e-3 * 0.3**2 * (1.0 - e**2), rel=1e-9, abs=1e-15)
    hertz = HertzContact(stiffness=1.25 * 4e-3 * 0.3**2 / 50e-6**2.5)
    assert found["found"]["Hertz"][0].duration[0] == approx(hertz.contact_time(4e-3, 0.3), rel=1e-5)


def coming_to_rest(found):
    w, hops, impacts = 10 * np.pi, found["hops"], found["impacts"]
    pressed = 105 - 4e-3 * found["model"].omega[0] ** 2
    assert 15e-3 * w**2 * np.sin(w * found["leaves"]) == approx(-pressed, rel=1e-9)
    assert hops[-9:] / hops[-10:-1] == approx(0.7, rel=1e-4)
    assert impacts.start[found["after"]] - found["landings"][-1] == approx(hops[-1] * 0.7 / 0.3, rel=1e-4)


def matrices_of_your_own(found):
    K, M, names, n = found["K"].toarray(), found["M"].toarray(), found["points"], found["times"] <= 0.06
    square, V = (part[..., :8] for part in eigh(K, M))
    rows, base, z, w = (
        np.array([names["roof"], -names["leg"]]) @ V,
        V.T @ M @ found["sideways"],
        4e-4,
        126 * np.pi,
    )

    def rate(t, y):
        push = 1e6 * np.maximum(0.0, rows @ y[:8] - [0.5e-3, 0.2e-3])
        return [*y[8:], *(base * z * w**2 * np.sin(w * t) - square * (y[:8] + 4e-5 * y[8:]) - push @ rows)]

    other = solve_ivp(rate, (0, 0.06), np.zeros(16), "DOP853", found["times"][n], rtol=1e-9, atol=1e-12)
    points = found["model"].points
    ours = found["motion"].displacement[n] @ np.transpose([points["roof"].row, -points["leg"].row])
    np.testing.assert_allclose(ours, (rows @ other.y[:8]).T, atol=1e-8)


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
