"""Films: where ball and plate are drawn, the frames of an orbit, and the files; with and without graphics."""

import numpy as np
import pytest
from PIL import Image

from beam import BRASS, DAMPING_TAPE, STEEL
from contact import StroboscopicMap
from contact.orbits import onset_orbit
from studies.experiment.film import drawn_shapes, film_orbit
from studies.shell import painter
from studies.shell.film import can_encode, write_gif, written_as_mp4
from studies.shell.painter import Moment, Scenery, stage_of
from studies.shell.scene import beam_at, modes_of
from studies.shell.scene.spring import metal_of

COARSE = {"spring.elements_per_leg": 20, "spring.elements_on_arc": 12, "modes.count": 12}


@pytest.fixture(scope="module")
def scene(letter_scene):
    return letter_scene.replace(COARSE)


@pytest.fixture(scope="module")
def modes(scene):
    return modes_of(scene)


def test_the_drawn_ball_meets_the_drawn_plate_when_the_tip_has_moved_by_the_gap(scene, modes):
    gap, radius = scene.stop.gap_m, scene.tip.ball_radius_m
    scenery = Scenery.of(modes, ball_radius=radius, gaps=[gap, -0.5 * gap], amplitude=gap)
    ball = scenery.mesh.points[np.unique(scenery.mesh.triangles)]
    (low, high), (_, other) = scenery.plates
    # the sphere is a polyhedron
    assert low[1] - ball[:, 1].max() == pytest.approx(gap, abs=0.02 * radius)
    under = ball[:, 1].min() - scene.spring.thickness_m  # the ball lies on the strip, which meets this plate
    assert under - other[1] == pytest.approx(0.5 * gap, abs=0.02 * radius)
    assert low[0] < ball[:, 0].mean() < high[0]
    assert not Scenery.of(modes, ball_radius=radius, amplitude=gap).plates
    assert scenery.strip == painter.BRASS
    assert [*map(metal_of, (BRASS, STEEL, DAMPING_TAPE))] == ["brass", "steel", ""]


def test_higher_modes_are_enlarged_and_the_tip_stays_where_it_is(scene, modes):
    scenery = Scenery.of(modes, ball_radius=scene.tip.ball_radius_m, gaps=[0.01], amplitude=0.01)
    coordinates = np.random.default_rng(1).normal(scale=[1e-3, 1e-4, 1e-5, 1e-5], size=(5, 4))
    tip = coordinates @ modes.phi[modes.coupled][:4]
    ball = np.unique(scenery.mesh.triangles)
    drawn = {m: drawn_shapes(scenery.mesh, modes, coordinates, m)[0] for m in (1.0, 10.0)}
    for points in drawn.values():
        np.testing.assert_allclose(points[:, ball].mean(axis=1)[:, 1], tip, rtol=1e-9)
        assert np.ptp(points[:, ball], axis=1).max() < 1e-15  # it does not turn
    assert np.abs(drawn[10.0] - drawn[1.0]).max() > 1e-5
    _, chosen = drawn_shapes(scenery.mesh, modes, coordinates)
    assert chosen >= 1.0 and chosen == round(chosen)


def test_the_frames_of_an_orbit_show_its_contact(scene):
    oscillator = beam_at(scene, 21.5).with_excess(0.013)
    settled = onset_orbit(StroboscopicMap(oscillator=oscillator), 0.013)
    orbit = film_orbit(oscillator, settled.end, settled.m, frames=80, rate=20.0)
    assert settled.m == 4 and len(orbit.contacts) == settled.impacts >= 1
    touched = orbit.touched[:, 0]
    assert touched.any() and np.all(orbit.tip[touched] >= oscillator.stop.gap * (1 - 1e-12))
    assert orbit.slowed[touched].min() > 20.0 * orbit.slowed.min()
    assert np.all(np.diff(orbit.time) > 0.0)
    assert orbit.base == pytest.approx(oscillator.drive.displacement(orbit.time))


def test_a_picture_shows_what_moves(scene, modes):
    scenery = Scenery.of(modes, ball_radius=scene.tip.ball_radius_m, gaps=[0.01, -0.01], amplitude=0.01)
    rest = Moment(points=np.zeros_like(scenery.mesh.points), base=np.zeros(3))
    bent = Moment(points=scenery.mesh.normalised(0.008)[0], base=np.zeros(3))
    touched, other = (Moment(points=rest.points, base=rest.base, touched=on) for on in ([1, 0], [0, 1]))
    stage = stage_of(scenery)
    pictures = [stage(moment) for moment in (rest, bent, touched, other, rest)]
    assert {picture.shape for picture in pictures} == {(painter.HEIGHT, painter.WIDTH, 3)}
    assert (pictures[0] == pictures[4]).all()
    for other in pictures[1:4]:
        assert 50 < np.any(pictures[0] != other, axis=2).sum() < 0.5 * painter.WIDTH * painter.HEIGHT
    # nothing is cut off: the border is white
    for picture in pictures:
        assert picture[0].min() == picture[-1].min() == picture[:, 0].min() == picture[:, -1].min() == 255


def test_what_is_near_hides_what_is_far():
    """A closed box shows the three faces that look to the viewer, and each face looks outwards."""
    faces = painter.box(np.array([(-1.0, -2.0, -3.0), (1.0, 2.0, 3.0)]))
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    assert len(faces) == 6 * 64 and np.all(np.sum(normal * faces.mean(axis=1), axis=1) > 0.0)
    assert np.linalg.norm(normal, axis=1).sum() == pytest.approx(2.0 * (2 * 4 + 4 * 6 + 6 * 2))
    view = painter.View.of(np.array([0.2, 0.3, 0.9]), np.array([(-1.0, -2.0, -3.0), (1.0, 2.0, 3.0)]), 0.5)
    places, shades = view.painted(faces, np.ones((len(faces), 3)))
    assert len(places) == 3 * 64 and np.abs(places).max() < 1.0 and len(np.unique(shades.round(9))) == 3
    np.testing.assert_allclose(view.axes @ view.axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(view.axes) == pytest.approx(1.0) and view(painter.DRIVE)[1] > 0.0  # up is up
    back = np.array([[(-0.1, -0.1, 0.0), (0.1, -0.1, 0.0), (0.1, 0.1, 0.0), (-0.1, 0.1, 0.0)]])
    near, far = np.eye(3)[0], np.eye(3)[1]
    _, shades = view.painted(np.concatenate([back + view.axes[2], back]), np.array([near, far]))
    assert shades[0] @ far > 0.0 and shades[1] @ near > 0.0  # the near one is painted last


def test_gif_and_mp4_hold_every_frame(tmp_path):
    stripes = np.repeat(np.linspace(40, 240, 6), 10).astype(np.uint8)
    pictures = [np.broadcast_to(np.roll(stripes, 10 * n)[None, :, None], (40, 60, 3)) for n in range(6)]
    passed = written_as_mp4(tmp_path / "film.mp4", pictures, 20.0) if can_encode() else pictures
    with Image.open(write_gif(tmp_path / "film.gif", passed, 20.0, samples=pictures[:1])) as found:
        assert (found.n_frames, found.size, found.info["loop"]) == (6, (60, 40), 0)
        for number, picture in enumerate(pictures):
            found.seek(number)
            assert found.info["duration"] == 50
            assert np.abs(np.asarray(found.convert("L"), dtype=int)[20] - picture[20, :, 0]).max() < 12
    if can_encode():
        assert (tmp_path / "film.mp4").stat().st_size > 500
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".gif", *([".mp4"] if can_encode() else [])]
