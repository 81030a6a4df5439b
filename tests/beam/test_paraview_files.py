"""Files for ParaView, read back and compared with what the modes say."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import beam
from beam.export import mode_name

RADIUS = 2.5e-3
BARE = beam.StripSection(material=beam.BRASS, width=12e-3, thickness=0.65e-3)
TAPED = replace(BARE, layer=beam.Layer(material=beam.DAMPING_TAPE, thickness=0.45e-3, both_sides=False))
U = dict(leg_length=0.13, bend_radius=7.5e-3, section=BARE, damped_section=TAPED, tip=beam.Tip(mass=5e-3))
DRAWN = dict(largest=0.01, ball_radius=RADIUS)


@pytest.fixture(scope="module")
def modes() -> beam.Modes:
    return beam.natural_modes(beam.assemble(beam.folded_u(**U)), 4)


def read(path: Path):
    import pyvista

    return pyvista.read(path)


def test_the_mesh_has_the_masses_of_the_strip_and_the_surface_of_the_ball(modes):
    mesh = beam.solid_spring(modes, ball_radius=RADIUS)
    sizes = mesh.grid().compute_cell_sizes()
    volume = [float(sizes["Volume"][mesh.part == part].sum()) for part in (beam.STRIP, beam.LAYER)]
    mass = beam.BRASS.density * volume[0] + beam.DAMPING_TAPE.density * volume[1]
    assert mass == pytest.approx(modes.discretization.spring.strip_mass, rel=1e-3)  # chords for arcs
    area = float(sizes["Area"][mesh.part == beam.BALL].sum())
    assert area == pytest.approx(4.0 * math.pi * RADIUS**2, rel=0.02)
    assert np.all(sizes["Volume"][mesh.part != beam.BALL] > 0.0)


def test_a_flat_u_is_drawn_with_the_slot_between_its_legs():
    spring = beam.flat_u(**U)
    mesh = beam.solid_spring(beam.natural_modes(beam.assemble(spring), 2), ball_radius=RADIUS)
    sizes = mesh.grid().compute_cell_sizes()
    volume = [float(sizes["Volume"][mesh.part == part].sum()) for part in (beam.STRIP, beam.LAYER)]
    mass = beam.BRASS.density * volume[0] + beam.DAMPING_TAPE.density * volume[1]
    assert mass == pytest.approx(spring.strip_mass, rel=1e-9)
    middle = mesh.points[mesh.hexahedra].mean(axis=1)
    legs, bend = middle[middle[:, 0] < 0.13], middle[middle[:, 0] > 0.13]
    assert np.unique(np.abs(legs[:, 2]).round(9)).tolist() == [7.5e-3] and np.all(bend[:, 2] == 0.0)
    edges = np.abs(mesh.points[np.unique(mesh.hexahedra), 2])
    assert [edges.min(), edges.max()] == pytest.approx([1.5e-3, 13.5e-3], rel=1e-12)
    faces, part = mesh.surface()
    assert len(faces) == len(part)


def test_triangles_of_the_ball_face_outwards(modes):
    mesh = beam.solid_spring(modes, ball_radius=RADIUS)
    centre = mesh.points[np.unique(mesh.triangles)].mean(axis=0)
    a, b, c = (mesh.points[mesh.triangles[:, i]] for i in range(3))
    assert np.all(np.einsum("ij,ij->i", np.cross(b - a, c - a), a - centre) > 0.0)
    edges = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2)  # closed


def test_cross_sections_stay_plane_and_turn_with_the_strip(modes):
    """A small motion keeps the distances within a cross-section, and its middle moves as the centreline."""
    mesh, along = beam.solid_spring(modes), modes.displacement_along(1)
    corner = mesh.hexahedra[:, :4]
    for mode in range(4):
        rest, shape = mesh.points[corner], mesh.shapes[mode][corner]
        for i, j in ((0, 1), (1, 2), (0, 2)):
            stretch = np.einsum("nk,nk->n", rest[:, i] - rest[:, j], shape[:, i] - shape[:, j])
            assert np.abs(stretch).max() < 1e-12 * np.abs(shape).max()
    strip = mesh.hexahedra[mesh.part == beam.STRIP][:, :4]
    middle = mesh.shapes[:, strip].mean(axis=2)
    place = mesh.points[strip].mean(axis=1)
    nearest = np.argmin(np.linalg.norm(along.points[None] - place[:, None], axis=2), axis=1)
    np.testing.assert_allclose(middle, along.displacement[:, nearest], atol=1e-9 * np.abs(middle).max())
    tilt = mesh.shapes[:, strip[:, 0]] - mesh.shapes[:, strip[:, 1]]
    expected = along.rotation[:, nearest, None] * along.tangent[nearest] * BARE.thickness
    np.testing.assert_allclose(tilt, expected, atol=1e-9 * np.abs(tilt).max())


def test_the_ball_moves_as_one_body_with_the_tip(modes):
    mesh = beam.solid_spring(modes, ball_radius=RADIUS)
    ball, spring = np.unique(mesh.triangles), modes.discretization.spring
    tip = spring.centreline.points(spring.tip_at)
    along = modes.displacement_along(1)
    at = int(np.argmin(np.abs(along.s - spring.tip_at)))
    offset = mesh.points[ball] - tip
    body = np.cross([0.0, 0.0, 1.0], offset)
    expected = along.displacement[:, at, None] + along.rotation[:, at, None, None] * body
    np.testing.assert_allclose(mesh.shapes[:, ball], expected, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(along.displacement[:, at, 1], modes.phi, atol=1e-6)


def test_mode_shapes_read_back(modes, tmp_path):
    rates = beam.StripDamping().decay_rates(modes)
    path = beam.write_modes(tmp_path / "modes.vtu", modes, decay_rates=rates, **DRAWN)
    grid = read(path)
    names = [mode_name(modes, mode) for mode in range(4)]
    assert list(grid.point_data) == names
    assert names[0].startswith("mode_01_2") and names[0].endswith("Hz")
    mesh = beam.solid_spring(modes, ball_radius=RADIUS)
    for mode, name in enumerate(names):
        vectors = grid.point_data[name]
        assert vectors.shape == (len(mesh.points), 3) and vectors.dtype.kind == "f"
        assert np.linalg.norm(vectors, axis=1).max() == pytest.approx(0.01, rel=1e-12)
        scale = 0.01 / np.linalg.norm(mesh.shapes[mode], axis=1).max()
        np.testing.assert_allclose(vectors, scale * mesh.shapes[mode], atol=1e-15)
    np.testing.assert_array_equal(grid.field_data["frequencies_hz"], modes.frequencies_hz)
    np.testing.assert_array_equal(grid.field_data["decay_rates_per_s"], rates)
    np.testing.assert_array_equal(grid.field_data["coupled"], [1, 0, 1, 0])
    assert grid.field_data["largest_displacement_m"].tolist() == [0.01]
    np.testing.assert_array_equal(grid.cell_data["part"], mesh.part)


@pytest.mark.parametrize("moved", [False, True])
def test_a_mode_in_motion_loops_without_a_seam(modes, tmp_path, moved):
    pvd = tmp_path / "sway & back.pvd"
    path, *frames = beam.write_mode_motion(pvd, modes, 2, frames=8, moved=moved, **DRAWN)
    sets = ET.parse(path).getroot().findall("Collection/DataSet")
    assert [path.parent / entry.attrib["file"] for entry in sets] == frames and len(frames) == 8
    period = 2.0 * math.pi / modes.omega[2]
    times = [float(entry.attrib["timestep"]) for entry in sets]
    np.testing.assert_allclose(times, period * np.arange(8) / 8, rtol=1e-14)
    mesh = beam.solid_spring(modes, ball_radius=RADIUS)
    grids = [read(frame) for frame in frames]
    shape = mesh.normalised(0.01)[2]
    motion = np.array([grid.point_data["displacement"] for grid in grids])
    for number, grid in enumerate(grids):
        expected = math.cos(2.0 * math.pi * number / 8) * shape
        np.testing.assert_allclose(motion[number], expected, atol=1e-15)
        np.testing.assert_allclose(grid.points, mesh.points + moved * expected, atol=1e-15)
        assert grid.field_data["TimeValue"][0] == times[number]
    steps = np.linalg.norm(np.roll(motion, -1, axis=0) - motion, axis=2).max(axis=1)
    assert steps[-1] == pytest.approx(steps[0], rel=1e-9)  # from the last frame back to the first


def test_wrong_use_is_refused(modes, tmp_path):
    vtu, pvd = tmp_path / "modes.vtu", tmp_path / "motion.pvd"
    for word, call in (
        (r"\.vtu", lambda: beam.write_modes(tmp_path / "modes.vtk", modes)),
        ("decay_rates", lambda: beam.write_modes(vtu, modes, decay_rates=[1.0])),
        ("largest", lambda: beam.write_modes(vtu, modes, largest=0.0)),
        ("mode is 4", lambda: beam.write_mode_motion(pvd, modes, 4)),
        ("frames", lambda: beam.write_mode_motion(pvd, modes, 0, frames=1)),
        ("ball_radius", lambda: beam.solid_spring(modes, ball_radius=-1.0)),
    ):
        with pytest.raises(ValueError, match=word):
            call()
    assert not list(tmp_path.iterdir())
