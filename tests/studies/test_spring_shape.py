"""The readings of "U shaped": sizes by second routes, twist modes."""

import math

import pytest
from conftest import verdicts_on
from straight_frame import uniform_beam

from beam import StripSection, assemble, exact_modes, flat_u, folded_u, natural_modes
from beam.space import spatial_modes
from studies.shell.run import Run
from studies.shell.scene import SceneError, read_scene, single_mode_of
from studies.spring.shape.__main__ import judge
from studies.spring.shape.shapes import brought_to, kinds_of, reading_row, shape_of, shapes_of

FOLDED = read_scene("tight_fold")


@pytest.fixture(scope="module")
def shapes():
    return shapes_of(FOLDED)


@pytest.fixture(scope="module")
def rows(shapes):
    return {name: reading_row(shape) for name, shape in shapes.items()}


def test_every_reading_has_the_free_period_of_the_letter(rows):
    omega = single_mode_of(FOLDED).omega[0]
    assert 2.0 * math.pi / math.sqrt(omega**2 - 1.78**2) == pytest.approx(40.80e-3, rel=1e-9)
    for row in rows.values():
        assert 2.0 * math.pi * row.first_bending_hz == pytest.approx(omega, rel=1e-6)


def test_the_sheet_of_the_plain_strip_by_the_frequency_equation(shapes):
    shape = shapes["plain"]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    beam = uniform_beam(strip, shape.length, shape.tip)
    assert exact_modes(beam, 1).omega[0] == pytest.approx(single_mode_of(FOLDED).omega[0], rel=1e-6)


@pytest.mark.parametrize(
    ("name", "drawn", "close"), [("folded", folded_u, 1e-4), ("side_by_side", flat_u, 1e-3)]
)
def test_the_sheet_of_a_u_by_the_plane_model(shapes, name, drawn, close):
    shape = shapes[name]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    spring = drawn(leg_length=shape.length, bend_radius=shape.bend_radius, section=strip, tip=shape.tip)
    omega = single_mode_of(FOLDED).omega[0]
    assert natural_modes(assemble(spring), 1).omega[0] == pytest.approx(omega, rel=close)
    if name == FOLDED.spring.kind.removesuffix("_u"):  # the scene has its tape on
        assert shape.thickness == pytest.approx(FOLDED.spring.thickness_m, rel=2e-3)


def test_the_table_says_what_the_study_claims(rows):
    ratio = {name: row.ratio_twist for name, row in rows.items()}
    assert ratio["plain"] > ratio["folded"] > ratio["side_by_side"] > ratio["channel"]
    assert ratio["folded"] == pytest.approx(16.6, abs=0.2)
    assert ratio["side_by_side"] == pytest.approx(7.8, abs=0.2)
    turn = {name: row.turn_of_twist for name, row in rows.items()}
    assert 10.0 * turn["side_by_side"] < turn["plain"] and 4.0 * turn["side_by_side"] < turn["folded"]
    for name, row in rows.items():
        assert row.tip_value_twist_off_line < 0.2 * row.tip_value_bending, name
        tips = row.tip_value_twist_off_line / row.tip_value_bending
        assert row.first_twist_hz > 30.0 * row.first_bending_hz * tips


def test_the_verdict_on_torsion(rows, tmp_path):
    run = Run(study="shape", folder=tmp_path, scene=FOLDED, command="")
    judge(run, rows)
    kept = run.close("done", {"rows": []})["verdicts"]
    assert {point: entry["verdict"] for point, entry in kept.items()} == verdicts_on("shape")


def test_kinds_of_the_folded_strip(shapes):
    kinds = kinds_of(shapes["folded"], spatial_modes(shapes["folded"].spring(), 7))
    assert kinds == ["bending", "breathing", "bending", "sideways", "breathing", "bending", "twist"]


def test_shapes_that_cannot_be_are_refused():
    with pytest.raises(SceneError, match="bend_radius_m"):
        shape_of(FOLDED.replace({"spring.width_m": 0.016}), "side_by_side")
    with pytest.raises(SceneError, match="no flange between"):
        brought_to(shape_of(FOLDED, "channel"), 2.0 * math.pi * 5.0)
