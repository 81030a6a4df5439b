"""Films of the spring: when frames are taken, what is drawn, and that it moves."""

from __future__ import annotations

import csv
import io
import json
import math
import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from beam.export import write_frames
from beam.spring_mesh import solid_spring
from contact.drive import HarmonicDrive
from contact.oscillator import ImpactOscillator
from contact.stop import Stop
from contact.stroboscope import StroboscopicMap
from studies import motion
from studies.instruments import off_screen
from studies.instruments.motion import film as film_files
from studies.instruments.motion.bench import bench_of
from studies.instruments.motion.film import can_encode, write_gif, write_mp4
from studies.instruments.motion.filmed_orbit import film_orbit
from studies.instruments.motion.magnified_shape import magnified_shape
from studies.instruments.motion.mode_film import frames_of, mode_film
from studies.instruments.motion.orbit_film import orbit_film, stage_of
from studies.instruments.motion.painted_stage import PaintedStage
from studies.instruments.motion.scene_bodies import choose_stage
from studies.instruments.motion.time_law import round_number, time_law
from studies.instruments.off_screen import can_render
from studies.instruments.oscillators import contact_law_of
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_of_scene import model_of, modes_of

COARSE = ("modes.count=4", "spring.elements_per_leg=12", "spring.elements_on_arc=12")
SMALL = [word for change in COARSE for word in ("--set", change)]
RADIUS = 2.5e-3


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter", COARSE)


@pytest.fixture(scope="module")
def modes(scene):
    return modes_of(scene)


@pytest.fixture(scope="module")
def film(scene, modes):
    """One drive period of a motion that meets the plate, from the steady motion beyond grazing."""
    oscillator = ImpactOscillator(
        model=model_of(scene),
        stop=Stop(gap=scene.stop.gap_m, law=contact_law_of(scene)),
        drive=HarmonicDrive(frequency=21.5),
    ).with_excess(0.02)
    start = StroboscopicMap(oscillator=oscillator).steady()
    orbit = film_orbit(oscillator, start, 0, frames=90, rate=20.0)
    return orbit_film(orbit, modes, ball_radius=RADIUS, width=480, height=184, shaken=True)


@pytest.fixture(scope="module")
def study(tmp_path_factory) -> tuple[Path, dict, str]:
    """Folder, summary and what was said of a small film, drawn where nothing can be rendered."""
    out = tmp_path_factory.mktemp("results")
    said = io.StringIO()
    patch = pytest.MonkeyPatch()
    patch.setattr(off_screen, "TRIAL", "import os; os.abort()")
    patch.setattr("sys.stderr", said)
    can_render.cache_clear()
    try:
        assert motion.main([*SMALL, "--frames", "24", "--out", str(out)]) == 0
    finally:
        patch.undo()
        can_render.cache_clear()
    folder = out / "motion"
    return folder, json.loads((folder / "summary.json").read_text()), said.getvalue()


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def gif_frames(path: Path) -> list[np.ndarray]:
    from PIL import Image, ImageSequence

    with Image.open(path) as image:
        assert image.info["loop"] == 0
        return [np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(image)]


# --- the time law


def test_round_numbers_are_round_and_next_to_the_value():
    assert [round_number(value) for value in (1.0, 1.2, 1.7, 2.5, 41.0, 900.0)] == [1, 1.5, 2, 3, 50, 1000]
    assert [round_number(value, up=False) for value in (1.0, 1.9, 11.3, 59.9)] == [1, 1.5, 10, 50]


@pytest.mark.parametrize("frames", [40, 120, 400])
def test_a_film_is_slow_at_the_contact_and_says_by_how_much(frames):
    spans = [(0.1, 0.1 + 5e-5)]
    law = time_law(0.186, spans, frames=frames, rate=20.0)
    assert 0.6 * frames < law.time.size <= frames
    assert law.time[0] == 0.0 and np.all(np.diff(law.time) > 0.0) and law.time[-1] < 0.186
    assert law.step.sum() == pytest.approx(0.186, rel=1e-12)
    inside = law.during(spans)
    assert inside.any() and law.slowed[inside].min() == law.slowed.max() > 4.0 * law.slowed.min()
    unmoved = np.flatnonzero(~(inside | np.roll(inside, -1) | np.roll(inside, 1)))[:-1]
    slowed = 1.0 / (20.0 * np.diff(law.time)[unmoved[unmoved < law.time.size - 1]])
    np.testing.assert_allclose(slowed, law.slowed[unmoved[unmoved < law.time.size - 1]], rtol=1e-6)
    away = np.abs(law.time - 0.1)
    assert law.slowed[np.argmin(away)] == law.slowed.max()
    assert law.slowed[away > 0.04].max() == law.slowed.min()
    if frames == 400:
        assert inside.sum() >= 5


def test_a_contact_that_takes_no_time_gets_its_own_frame():
    spans = [(0.05, 0.05), (0.0713, 0.0713)]
    law = time_law(0.1, spans, frames=40)
    assert law.during(spans).sum() == 2
    assert {0.05, 0.0713} <= set(law.time.tolist())


def test_a_film_without_contacts_runs_evenly_and_too_short_a_film_is_refused():
    law = time_law(0.1, [], frames=60)
    assert np.unique(law.slowed).size == 1 and not law.during([]).any()
    with pytest.raises(ValueError, match="2 contacts needs at least 24 frames"):
        time_law(0.1, [(0.02, 0.02), (0.05, 0.051), (0.12, 0.12)], frames=23)


# --- what is drawn


def test_the_surface_of_the_strip_is_closed_and_faces_outwards(modes):
    mesh = solid_spring(modes)
    faces, part = mesh.surface()
    for kind in np.unique(part):
        corners = mesh.points[faces[part == kind]]
        halves = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
        volume = np.einsum("ij,ij->i", halves[:, 0], np.cross(halves[:, 1], halves[:, 2])).sum() / 6.0
        sizes = mesh.grid().compute_cell_sizes()["Volume"]
        assert volume == pytest.approx(float(sizes[mesh.part == kind].sum()), rel=1e-3)


def test_enlarging_the_higher_modes_leaves_the_tip_and_the_first_mode_alone(modes):
    mesh = solid_spring(modes, ball_radius=RADIUS)
    kept = np.flatnonzero(modes.coupled)[:4]
    row = np.array([[1e-3, 2e-4, -1e-4, 3e-5]])
    plain = np.tensordot(row[0], mesh.shapes[kept], axes=1)
    true = magnified_shape(mesh, modes, row, 1.0).displacement(row[0])
    np.testing.assert_allclose(true, plain, atol=1e-15)
    shape = magnified_shape(mesh, modes, row, 8.0)
    np.testing.assert_allclose(shape.displacement(row[0], magnified=False), plain, atol=1e-15)
    first = float(row[0] @ modes.phi[kept]) * mesh.shapes[kept[0]] / modes.phi[kept[0]]
    np.testing.assert_allclose(shape.displacement(row[0]) - first, 8.0 * (plain - first), atol=1e-15)
    spring = modes.discretization.spring
    strip = np.unique(mesh.hexahedra)
    distance = np.linalg.norm(mesh.points[strip] - spring.centreline.points(spring.tip_at), axis=1)
    section = strip[distance < 7e-3]
    middle = shape.displacement(row[0])[section[np.argsort(distance[distance < 7e-3])[:4]]].mean(axis=0)
    assert middle[1] == pytest.approx(float(row[0] @ modes.phi[kept]), rel=1e-6)
    only_first = np.array([[1e-3, 0.0, 0.0, 0.0]])
    assert magnified_shape(mesh, modes, only_first).magnification == 1.0


def test_the_magnification_is_the_largest_round_number_that_has_room(modes):
    mesh = solid_spring(modes, ball_radius=RADIUS)
    row = np.array([[1e-3, 1e-4, 0.0, 0.0]])
    shape = magnified_shape(mesh, modes, row)
    strip = np.unique(mesh.hexahedra)
    departure = shape.displacement(row[0]) - float(row[0] @ shape.phi) * shape.first
    largest = np.linalg.norm(departure[strip], axis=1).max()
    room = 0.07 * np.ptp(mesh.points[strip], axis=0).max()
    assert shape.magnification > 1.0 and room / 1.6 < largest <= room


def test_the_ball_meets_the_plate_when_the_tip_has_moved_by_the_gap(modes):
    for gap in (0.004, 0.0107):
        mesh = solid_spring(modes, ball_radius=RADIUS)
        bench = bench_of(mesh, modes, ball_radius=RADIUS, gap=gap, swing=gap)
        ball = mesh.points[np.unique(mesh.triangles)]
        plate = bench.stop[0].corners
        face = plate[:, 1].min()
        assert face - gap == pytest.approx(ball[:, 1].mean() + RADIUS, abs=1e-9)
        low, high = plate.min(axis=0), plate.max(axis=0)
        assert np.all(low <= bench.meeting + 1e-12) and np.all(bench.meeting <= high + 1e-12)


def test_the_enlarged_strip_never_runs_into_the_plate_and_the_ball_touches_it_in_contact(film):
    plate = film.bodies.bench.stop[0].corners
    strip = np.unique(film.mesh.hexahedra)
    assert film.orbit.touching.any()
    for number in range(film.count):
        moment = film.moment(number)
        places = (film.mesh.points + moment.points)[strip]
        low, high = (plate + moment.pressed).min(axis=0), (plate + moment.pressed).max(axis=0)
        assert not np.any(np.all((places > low) & (places < high), axis=1))
        into = film.bodies.ball_centre[1] + RADIUS + moment.ball[1] - low[1]
        assert into < 1e-9 and (into > -1e-9) == moment.flash


def test_a_point_is_painted_where_the_view_puts_it(film):
    stage = PaintedStage(film.bodies, film.view)
    number = int(np.flatnonzero(film.orbit.touching)[0])
    lit, dark = film.moment(number), film.moment(0)
    picture, before = stage.picture(lit), stage.picture(dark)
    assert picture.shape == (184, 480, 3) and np.all(before[:2] == 255)  # a light ground
    plate = film.bodies.bench.stop[0].centre
    for image, moment, bright in ((picture, lit, True), (before, dark, False)):
        column, row = np.round(film.view.places(plate + moment.base)).astype(int)
        red, _, blue = image[row, column].astype(int)
        assert (red - blue > 120) == bright  # orange in contact, grey otherwise
        ball = film.bodies.ball_centre + moment.ball + moment.base
        column, row = np.round(film.view.places(ball)).astype(int)
        assert np.ptp(image[row, column].astype(int)) < 25 and image[row, column].mean() > 150  # ceramic
    stage.close()


@pytest.mark.skipif(not can_render(), reason="no rendering off the screen on this machine")
def test_both_stages_draw_the_same_picture(film):
    pictures = []
    for name in ("vtk", "matplotlib"):
        stage = stage_of(name, film.bodies, film.view)
        pictures.append(stage.picture(film.moment(5)).astype(float))
        other = stage.picture(film.moment(20)).astype(float)
        stage.close()
        assert np.abs(other - pictures[-1]).max() > 100.0  # the shape moves, and not only its colour
    brass = [(image[..., 0] - image[..., 2] > 60.0) for image in pictures]
    assert brass[0].sum() > 500
    assert (brass[0] & brass[1]).sum() > 0.85 * (brass[0] | brass[1]).sum()
    sky = [np.all(image > 250.0, axis=2) for image in pictures]
    assert (sky[0] & sky[1]).sum() > 0.97 * (sky[0] | sky[1]).sum()


def test_a_machine_without_graphics_is_told_what_to_install(monkeypatch):
    monkeypatch.setattr(off_screen, "TRIAL", "import os; os.abort()")
    can_render.cache_clear()
    try:
        renderer, sentence = choose_stage("auto")
        assert renderer == "matplotlib" and "libegl1 libegl-mesa0 libgl1-mesa-dri" in sentence
        with pytest.raises(ValueError, match="libegl1 libegl-mesa0 libgl1-mesa-dri"):
            choose_stage("vtk")
    finally:
        can_render.cache_clear()


# --- films of modes


def test_the_film_of_a_mode_moves_the_shape_and_has_no_seam(modes):
    count = 6
    film = mode_film(modes, 3, largest=0.006, ball_radius=RADIUS)
    stage = PaintedStage(film.bodies, film.view)
    for mode in (0, 1):
        moments = [film.moment(mode, number / count) for number in range(count + 1)]
        np.testing.assert_allclose(moments[count].points, moments[0].points, atol=1e-15)
        steps = [
            float(np.linalg.norm(after.points - before.points, axis=1).max())
            for before, after in pairwise(moments)
        ]
        assert min(steps) > 0.2 * 0.006
        assert steps[-1] == pytest.approx(steps[0], rel=1e-9)  # the way back to the first is one more step
        frames = list(frames_of(film, stage, mode, count))
        for before, after in zip(frames, [*frames[1:], frames[0]], strict=True):
            changed = np.abs(after.astype(int) - before.astype(int)).max(axis=2) > 40
            assert changed.sum() > 200
        np.testing.assert_array_equal(frames[1], frames[count - 1])  # cos is even
    with pytest.raises(ValueError, match="even"):
        next(frames_of(film, stage, 0, 5))


# --- files


def test_a_gif_has_every_frame_as_it_was_and_runs_for_ever(tmp_path):
    frames = [np.full((20, 30, 3), 255, dtype=np.uint8) for _ in range(4)]
    for number, frame in enumerate(frames):
        frame[4:10, 3 + 5 * number : 8 + 5 * number] = (0, 114, 178)
    path = write_gif(tmp_path / "square.gif", frames, 20.0)
    for seen, wanted in zip(gif_frames(path), frames, strict=True):
        assert np.abs(seen.astype(int) - wanted).max() <= 3
    assert {file.name for file in tmp_path.iterdir()} == {"square.gif"}


@pytest.mark.skipif(not can_encode(), reason="the extra `video` is not installed")
def test_an_mp4_has_every_frame(tmp_path):
    import imageio_ffmpeg

    frames = [np.full((64, 96, 3), 40 * number, dtype=np.uint8) for number in range(5)]
    reader = imageio_ffmpeg.read_frames(str(write_mp4(tmp_path / "grey.mp4", frames, 20.0)))
    meta = next(reader)
    levels = [float(np.frombuffer(frame, np.uint8).mean()) for frame in reader]
    assert meta["size"] == (96, 64) and meta["fps"] == 20.0 and meta["codec"] == "h264"
    assert levels == pytest.approx([0.0, 40.0, 80.0, 120.0, 160.0], abs=3.0)
    assert {file.name for file in tmp_path.iterdir()} == {"grey.mp4"}


def test_frames_that_were_interrupted_are_listed_as_far_as_they_are_complete(modes, tmp_path):
    mesh = solid_spring(modes)

    def grids(count, broken=False):
        for number in range(count):
            yield 0.1 * number, mesh.grid()
        if broken:
            raise KeyboardInterrupt

    path, *_ = write_frames(tmp_path / "motion.pvd", grids(4))
    with pytest.raises(KeyboardInterrupt):
        write_frames(path, grids(2, broken=True))
    listed = [entry.attrib["file"] for entry in ET.parse(path).getroot().findall("Collection/DataSet")]
    assert listed == ["motion_frames/frame_0000.vtu", "motion_frames/frame_0001.vtu"]
    write_frames(path, grids(3))
    names = {file.name for file in (tmp_path / "motion_frames").iterdir()}
    assert names == {"frame_0000.vtu", "frame_0001.vtu", "frame_0002.vtu"}  # no leftovers, no hidden files
    assert {file.name for file in tmp_path.iterdir()} == {"motion.pvd", "motion_frames"}


# --- the study


def test_the_study_writes_its_files_and_says_what_is_missing(study):
    folder, results, said = study
    wanted = {"motion.gif", "motion.pvd", "motion_frames", "motion.png", "motion.pdf"}
    wanted |= {"frames.csv", "strobes.csv"}
    assert wanted | ({"motion.mp4"} if can_encode() else set()) <= set(results["files"])
    assert all((folder / name).exists() for name in results["files"])
    assert not [file for file in folder.iterdir() if file.name.startswith(".")]
    assert said.count("libegl1 libegl-mesa0 libgl1-mesa-dri") == 1
    assert ("no mp4" in said) == (not can_encode())
    assert results["renderer"] == "matplotlib" and results["period"] == 4 and results["impacts"] >= 1
    assert results["duration_s"] == pytest.approx(4.0 / 21.5, rel=1e-12)
    assert (folder / "motion.gif").stat().st_size < 5e6
    told = {entry["slowed"]: entry["frames"] for entry in results["slow_motion"]}
    assert sum(told.values()) == results["frames"] <= 24 and len(told) > 1


def test_the_frames_are_those_of_the_orbit(study, scene):
    folder, results, _ = study
    rows = rows_of(folder / "frames.csv")
    tip = np.array([float(row["tip_m"]) for row in rows])
    force = np.array([float(row["force_n"]) for row in rows])
    contact = np.array([row["contact"] == "1" for row in rows])
    assert len(rows) == results["frames"] and contact.sum() >= results["impacts"]
    assert np.all(force[contact] > 0.0) and np.all(force[~contact] == 0.0)
    gap = scene.stop.gap_m
    assert np.all(tip[contact] > gap) and np.all(tip[~contact] < gap)
    strobes = rows_of(folder / "strobes.csv")
    assert len(strobes) == 4
    assert len({round(float(row["tip_m"]), 6) for row in strobes}) == 4  # four different points of a p4
    assert tip[0] == pytest.approx(float(strobes[0]["tip_m"]), abs=1e-12)


def test_the_film_moves_and_does_not_jitter(study):
    folder, results, _ = study
    frames = gif_frames(folder / "motion.gif")
    assert len(frames) == results["frames"] and {frame.shape for frame in frames} == {(720, 960, 3)}
    picture = slice(62, 430)
    for before, after in zip(frames, [*frames[1:], frames[0]], strict=True):
        assert np.any(before[picture] != after[picture])
    flight = [np.abs(b[picture].astype(int) - a[picture]).max(axis=2) for a, b in pairwise(frames)]
    assert np.median([(change > 40).sum() for change in flight]) > 2000  # the shape, not a shade
    left = np.stack([frame[:60, :500] for frame in frames])
    assert np.all(left == left[0])  # title and scale stay
    ticks = np.stack([frame[665:, :] for frame in frames])
    assert np.all(ticks == ticks[0])  # axes of the panels stay


def test_strobe_points_appear_one_by_one(study):
    folder, _, _ = study
    rows, frames = rows_of(folder / "frames.csv"), gif_frames(folder / "motion.gif")
    seen = []
    for frame in frames:
        panel = frame[450:665, 60:340].astype(int)
        seen.append(int(((panel[..., 0] > 190) & (panel[..., 1] < 130) & (panel[..., 2] < 60)).sum()))
    passed = np.array([1 + math.floor(float(row["time_s"]) * 21.5 + 1e-9) for row in rows])
    levels = [np.median(np.array(seen)[passed == count]) for count in (1, 2, 3, 4)]
    assert levels[0] > 20 and np.all(np.diff(levels) > 20)


def test_paraview_gets_the_motion_itself_and_what_is_drawn(study, scene):
    import pyvista

    gap = scene.stop.gap_m
    folder, results, _ = study
    sets = ET.parse(folder / "motion.pvd").getroot().findall("Collection/DataSet")
    rows = rows_of(folder / "frames.csv")
    assert [float(entry.attrib["timestep"]) for entry in sets] == [float(row["time_s"]) for row in rows]
    grids = [pyvista.read(folder / entry.attrib["file"]) for entry in sets]
    rest = grids[0].points - grids[0].point_data["displacement_drawn"]
    flashed = [bool(grid.cell_data["contact"].any()) for grid in grids]
    assert flashed == [row["contact"] == "1" for row in rows] and any(flashed)
    for grid, row in zip(grids, rows, strict=True):
        np.testing.assert_allclose(grid.points - grid.point_data["displacement_drawn"], rest, atol=1e-9)
        plate = grid.extract_cells(np.flatnonzero(grid.cell_data["part"] == 3))
        pressed = plate.point_data["displacement"][:, 1]
        np.testing.assert_allclose(pressed, max(0.0, float(row["tip_m"]) - gap), atol=1e-12)
        base = plate.point_data["displacement_drawn"][:, 1] - pressed
        np.testing.assert_allclose(base, float(row["base_m"]), atol=1e-12)
        ball = grid.extract_cells(np.flatnonzero(grid.cell_data["part"] == 2))
        np.testing.assert_allclose(ball.point_data["displacement"][:, 1], float(row["tip_m"]), atol=1e-12)
        assert grid.field_data["magnification"][0] == results["magnification"]
    steps = [np.abs(b.points - a.points).max() for a, b in zip(grids, [*grids[1:], grids[0]], strict=True)]
    assert min(steps) > 0.0 and max(steps) > 1e-3


def test_an_interruption_keeps_what_was_written(tmp_path, monkeypatch, capfd):
    drawn = PaintedStage.picture
    count = iter(range(3))

    def picture(self, moment):
        if next(count, None) is None:
            raise KeyboardInterrupt
        return drawn(self, moment)

    monkeypatch.setattr(PaintedStage, "picture", picture)
    line = [*SMALL, "--frames", "24", "--renderer", "matplotlib", "--seen-from", "base"]
    assert motion.main([*line, "--out", str(tmp_path)]) == 130
    folder = tmp_path / "motion"
    names = {file.name for file in folder.iterdir()}
    assert {"frames.csv", "strobes.csv", "motion.pvd", "motion_frames", "summary.json"} <= names
    assert not names & {"motion.gif", "motion.mp4", "motion.png"} and not [n for n in names if n[0] == "."]
    assert json.loads((folder / "summary.json").read_text())["status"] == "interrupted"
    assert "--seen-from base" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--frames", "8"], "needs at least 24 frames"),
        (["--frames", "0"], "--frames"),
        (["--magnify", "0"], "--magnify"),
        (["--excess", "-1"], "--excess"),
        (["--frequency", "x"], "--frequency"),
    ],
)
def test_wrong_use_is_told_in_one_sentence(words, sentence, tmp_path, capfd):
    assert motion.main([*SMALL, "--renderer", "matplotlib", *words, "--out", str(tmp_path)]) == 2
    err = capfd.readouterr().err
    assert sentence in err and len(err.strip().splitlines()) == 1


def test_without_ffmpeg_the_extra_is_named(monkeypatch):
    monkeypatch.setattr(film_files.importlib.util, "find_spec", lambda name: None)
    assert not can_encode() and "[video]" in film_files.NO_VIDEO
