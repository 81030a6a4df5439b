"""The study of the natural modes, from the command line to the files."""

from __future__ import annotations

import csv
import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from beam import UniformBeam, exact_modes
from beam.export import write_mode_motion
from studies.instruments import off_screen
from studies.instruments.mode_figures import draw
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_of_scene import modes_of, spring_of
from studies.modes import exact_frequencies, main, printed, table_of

COARSE = ("modes.count=3", "spring.elements_per_leg=12", "spring.elements_on_arc=12")
SMALL = [word for change in COARSE for word in ("--set", change)]
DATA = {
    "spring.kind": "modal_data",
    "modal_data.frequencies_hz": [24.5, 150.0],
    "modal_data.decay_rates_per_s": [3.5, 20.0],
    "modal_data.tip_values": [8.0, 5.0],
    "modal_data.participation": [0.14, -0.05],
}


@pytest.fixture(scope="module")
def folded(tmp_path_factory) -> tuple[Path, str]:
    """Folder of results of the folded strip; the study is run once."""
    out = tmp_path_factory.mktemp("results")
    assert main([*SMALL, "--out", str(out), "--quick", "--mode", "3", "--frames", "6"]) == 0
    return out / "modes"


def test_all_files_are_there_and_listed(folded):
    results = json.loads((folded / "summary.json").read_text())
    named = {"modes.csv", "modes.npz", "modes.vtu", "motion.pvd", "motion_frames", "modes.png", "modes.pdf"}
    named |= {"modes_3d.png", "modes_3d.pdf", "mode_1.gif", "mode_2.gif"}
    assert named <= set(results["files"])
    assert {*results["files"], "summary.json", "manifest.json"} == {path.name for path in folded.iterdir()}
    assert len(list((folded / "motion_frames").iterdir())) == 6


def test_the_table_tells_sway_from_breathing(folded):
    results = json.loads((folded / "summary.json").read_text())
    assert results["coupled"] == [True, False, True, False, True]
    for coupled, tip, participation in zip(
        results["coupled"], results["tip_values"], results["participation"], strict=True
    ):
        assert (tip > 0.0) == coupled == (participation != 0.0)
    assert results["exact_hz"] == [None] * 5  # no frequency equation for a folded strip
    assert results["decay_rates"][0] == pytest.approx(3.56, rel=1e-12)
    rows = list(csv.DictReader((folded / "modes.csv").read_text().splitlines()))
    np.testing.assert_allclose([float(row["frequency_hz"]) for row in rows], results["frequencies_hz"])


def test_the_animated_mode_is_the_one_that_was_asked_for_and_moves_by_itself(folded):
    import pyvista

    shapes, frame = pyvista.read(folded / "modes.vtu"), pyvista.read(folded / "motion_frames/frame_0000.vtu")
    name = list(shapes.point_data)[2]
    assert name.startswith("mode_03_")
    np.testing.assert_allclose(frame.point_data["displacement"], shapes.point_data[name], atol=1e-15)
    np.testing.assert_allclose(frame.points - shapes.points, shapes.point_data[name], atol=1e-15)


def test_frames_for_paraview_move_the_points_and_have_no_seam(folded):
    import pyvista

    sets = ET.parse(folded / "motion.pvd").getroot().findall("Collection/DataSet")
    grids = [pyvista.read(folded / entry.attrib["file"]) for entry in sets]
    swing = np.linalg.norm(grids[0].point_data["displacement"], axis=1).max()
    steps = [
        np.linalg.norm(after.points - before.points, axis=1).max()
        for before, after in zip(grids, [*grids[1:], grids[0]], strict=True)
    ]
    assert min(steps) > 0.2 * swing
    assert steps[-1] == pytest.approx(steps[0], rel=1e-9)


@pytest.mark.parametrize("mode", [1, 2])
def test_films_of_modes_move_the_shape_in_every_frame(folded, mode):
    from PIL import Image, ImageSequence

    with Image.open(folded / f"mode_{mode}.gif") as film:
        assert film.info["loop"] == 0
        frames = [np.asarray(frame.convert("RGB")).astype(int) for frame in ImageSequence.Iterator(film)]
    assert len(frames) == 6 and {frame.shape for frame in frames} == {(260, 720, 3)}
    brass = [frame[..., 0] - frame[..., 2] > 60 for frame in frames]
    for number in range(6):
        here, there = brass[number], brass[(number + 1) % 6]
        assert (here & there).sum() < 0.8 * (here | there).sum()  # elsewhere, not only another colour
    # the seam: from the last frame to the first is as long a step as from the first to the second
    np.testing.assert_array_equal(brass[5], brass[1])


def test_an_odd_number_of_frames_is_refused(tmp_path):
    modes = modes_of(read_scene().replace({"modes.count": 1}))
    with pytest.raises(ValueError, match="even"):
        write_mode_motion(tmp_path / "motion.pvd", modes, 0, frames=5)


def test_json_is_alone_on_standard_output(capfd, tmp_path):
    line = ["--set", "spring.kind=cantilever", *SMALL, "--quick", "--frames", "2", "--out", str(tmp_path)]
    assert main([*line, "--json"]) == 0
    out, err = capfd.readouterr()
    answer = json.loads(out)
    assert answer["schema"] == 1 and answer["exit_code"] == 0
    wanted = {"frequencies_hz", "exact_hz", "tip_values", "participation", "coupled", "decay_rates", "files"}
    assert wanted <= set(answer)
    np.testing.assert_allclose(answer["frequencies_hz"], answer["exact_hz"], rtol=3e-4)
    assert "Warp By Vector" in err and "ParaView" in err and "exact (Hz)" in err


@pytest.mark.parametrize(
    ("changes", "rigid"),
    [
        ({"spring.kind": "cantilever"}, 0),
        ({"spring.end_support": "pinned", "tip.mass_kg": 0.0, "tip.arc_fraction": 0.6}, 0),
        ({"spring.start_support": "pinned"}, 1),
        ({"spring.start_support": "free"}, 2),
        ({"tip.rotary_inertia_kg_m2": 1e-6}, 0),
    ],
)
def test_straight_strips_agree_with_the_frequency_equation(changes, rigid):
    scene = read_scene().replace({"spring.kind": "straight_strip", "modes.count": 5, **changes})
    modes = modes_of(scene)
    exact = exact_frequencies(modes.discretization.spring, 5)
    assert exact is not None and np.sum(exact == 0.0) == rigid == np.sum(modes.omega == 0.0)
    np.testing.assert_allclose(modes.frequencies_hz, exact, rtol=1e-6)
    assert "-" in printed(table_of(scene, modes)) and "yes" in printed(table_of(scene, modes))


def test_the_frequency_equation_is_not_used_where_it_does_not_hold():
    scene = read_scene().replace({"spring.kind": "cantilever"})
    assert exact_frequencies(spring_of(read_scene()), 3) is None
    assert exact_frequencies(spring_of(scene.replace({"spring.tape_coverage": 0.5})), 3) is None
    middle = {"spring.kind": "straight_strip", "tip.arc_fraction": 0.5}
    assert exact_frequencies(spring_of(scene.replace(middle)), 3) is None
    section = spring_of(scene).sections[0]
    beam = UniformBeam(length=0.13, bending_stiffness=section.bending_stiffness,
                       mass_per_length=section.mass_per_length, tip_mass=scene.tip.mass_kg)
    found = exact_frequencies(spring_of(scene), 3)
    np.testing.assert_allclose(found, exact_modes(beam, 3).omega / (2.0 * math.pi), rtol=1e-14)


def test_modes_that_were_measured_have_a_table_and_no_shapes(tmp_path, capfd):
    sets = [word for key, value in DATA.items() for word in ("--set", f"{key}={value}")]
    assert main([*sets, "--out", str(tmp_path)]) == 0
    assert "no shapes" in capfd.readouterr().err
    assert {path.name for path in (tmp_path / "modes").iterdir()} == {
        "modes.csv", "summary.json", "manifest.json"
    }


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--mode", "9"], "--mode must be at most 5"),
        (["--mode", "0"], "--mode"),
        (["--frames", "1"], "--frames must be an even number of at least 2, not 1"),
        (["--frames", "5"], "--frames must be an even number of at least 2, not 5"),
        (["--set", "spring.kind=straight_strip", "--set", "spring.end_support=clamped"], "tip.arc_fraction"),
    ],
)
def test_wrong_use_is_told_in_one_sentence(words, sentence, tmp_path, capfd):
    assert main([*SMALL, *words, "--out", str(tmp_path)]) == 2
    err = capfd.readouterr().err
    assert sentence in err and len(err.strip().splitlines()) == 1


def test_without_graphics_matplotlib_draws_and_the_packages_are_named(tmp_path, capfd, monkeypatch):
    monkeypatch.setattr(off_screen, "TRIAL", "import os; os.abort()")
    off_screen.can_render.cache_clear()
    try:
        assert main([*SMALL, "--frames", "2", "--out", str(tmp_path)]) == 0
    finally:
        off_screen.can_render.cache_clear()
    err = capfd.readouterr().err
    assert err.count("libegl1 libegl-mesa0 libgl1-mesa-dri") == 1
    films = {f"mode_{number}.gif" for number in range(1, 6)}
    assert films | {"modes_3d.png"} <= {path.name for path in (tmp_path / "modes").iterdir()}


def test_the_figure_draws_every_mode_to_scale_with_units():
    modes = modes_of(read_scene().replace({"modes.count": 2}))
    along = modes.displacement_along(2)
    shapes = {
        "frequencies_hz": modes.frequencies_hz,
        "coupled": modes.coupled,
        "arc_length_m": along.s,
        "points_m": along.points,
        "displacement": along.displacement,
        "tip_at_m": modes.discretization.spring.tip_at,
    }
    figure = draw(shapes, 2.5e-3)
    shown = [ax for ax in figure.axes if ax.get_visible()]
    assert len(shown) == 3
    assert [ax.get_title(loc="left").split(":")[0] for ax in shown] == ["mode 1", "mode 2", "mode 3"]
    assert all(ax.get_aspect() == 1.0 for ax in shown)
    assert shown[0].get_ylabel() == "y (mm)" and shown[-1].get_xlabel() == "x (mm)"
    swing = shown[0].lines[3].get_ydata() - shown[0].lines[0].get_ydata()
    assert np.abs(swing).max() == pytest.approx(0.05 * 137.5, rel=0.01)
