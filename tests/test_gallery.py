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
