"""The study of the readings of "U shaped": sizes by second routes, the table, the files and the figures."""

from __future__ import annotations

import csv
import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

from beam import StripSection, Tip, UniformBeam, assemble, exact_modes, folded_u, natural_modes
from beam.space import spatial_modes
from studies.instruments.quantities import SceneError
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_shape.checks import plate_excess
from studies.instruments.spring_shape.figures import draw_channels, draw_errors, draw_shapes, draw_widths
from studies.instruments.spring_shape.readings import (
    READINGS,
    angular_frequency_of,
    brought_to,
    kinds_of,
    shape_of,
)
from studies.instruments.spring_shape.surfaces import net_of
from studies.instruments.spring_shape.table import compact_mount, row_of, shapes_of
from studies.instruments.spring_shape.words import verdict_of, verdict_words
from studies.spring_shape import main


@pytest.fixture(scope="module")
def scene():
    return read_scene("letter", [])


@pytest.fixture(scope="module")
def shapes(scene):
    return shapes_of(scene, READINGS)


@pytest.fixture(scope="module")
def rows(shapes):
    return {name: row_of(shape, 5e-4) for name, shape in shapes.items()}


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("results")
    assert main(["--quick", "--out", str(out), "--off-line", "0.0004"]) == 0
    return out / "spring_shape"


@pytest.fixture(scope="module")
def summary(results) -> dict:
    return json.loads((results / "summary.json").read_text())


def test_every_reading_has_the_free_period_of_the_letter(scene, rows):
    omega = angular_frequency_of(scene)
    assert 2.0 * math.pi / math.sqrt(omega**2 - 1.78**2) == pytest.approx(40.80e-3, rel=1e-9)
    for row in rows.values():
        assert 2.0 * math.pi * row["first_bending_hz"] == pytest.approx(omega, rel=1e-6)


def test_the_sheet_of_the_plain_strip_by_the_frequency_equation(scene, shapes):
    shape = shapes["plain"]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    beam = UniformBeam(
        length=shape.length, bending_stiffness=strip.bending_stiffness,
        mass_per_length=strip.mass_per_length, tip_mass=shape.tip.mass,
    )
    assert exact_modes(beam, 1).omega[0] == pytest.approx(angular_frequency_of(scene), rel=1e-6)


def test_the_sheet_of_the_folded_strip_by_the_plane_model(scene, shapes):
    shape = shapes["folded"]
    strip = StripSection(material=shape.material, width=shape.width, thickness=shape.thickness)
    spring = folded_u(leg_length=shape.length, bend_radius=shape.bend_radius, section=strip, tip=shape.tip)
    assert natural_modes(assemble(spring), 1).omega[0] == pytest.approx(angular_frequency_of(scene), rel=1e-4)
    assert shape.thickness == pytest.approx(scene.spring.thickness_m, rel=2e-3)  # the scene has its tape on


def test_twist_of_the_plain_strip_by_hand(rows, shapes):
    """(1/4L) sqrt(GJ/I), the clamp taking b sqrt(E/48G) of the length away; the ball is on the axis."""
    shape = shapes["plain"]
    section, b, material = shape.section, shape.width, shape.material
    free = shape.length - b * math.sqrt(material.youngs_modulus / (48.0 * material.shear_modulus))
    by_hand = math.sqrt(section.torsional_stiffness / section.polar_inertia) / (4.0 * free)
    assert rows["plain"]["first_twist_hz"] == pytest.approx(by_hand, rel=2e-3)


def test_the_table_says_what_the_study_claims(rows):
    ratio = {name: row["ratio_twist"] for name, row in rows.items()}
    assert ratio["plain"] > ratio["folded"] > ratio["side_by_side"] > ratio["channel"]
    assert ratio["folded"] == pytest.approx(16.6, abs=0.2)
    assert ratio["side_by_side"] == pytest.approx(7.8, abs=0.2)
    for row in rows.values():
        assert row["tip_value_twist"] < 1e-4 * row["tip_value_bending"]
        assert row["tip_value_twist_off_line"] > 10.0 * row["tip_value_twist"]
        assert row["ratio"] <= row["ratio_twist"] and row["compliance_share_off_line"] < 1e-3


def test_a_mount_with_rotary_inertia_lowers_the_twist_of_the_plain_strip_most(scene, shapes, rows):
    mount = compact_mount(scene)
    assert mount.mass == scene.tip.mass_kg and 5e-8 < mount.rotary_inertia < 1e-7
    fall = {}
    for name in ("plain", "folded", "side_by_side"):
        heavier = row_of(dataclasses.replace(shapes[name], tip=mount), 5e-4)
        fall[name] = 1.0 - heavier["first_twist_hz"] / rows[name]["first_twist_hz"]
    assert fall["plain"] > 0.2 > fall["folded"] > 0.05 > fall["side_by_side"] > 0.0


def test_a_light_ball_off_the_line_sees_its_distance_times_the_turn(shapes):
    light = dataclasses.replace(shapes["folded"], tip=Tip(mass=1e-8))
    row = row_of(light, 5e-4)
    assert row["tip_value_twist_off_line"] == pytest.approx(5e-4 * row["turn_of_twist"], rel=1e-3)


def test_kinds_of_the_folded_strip(shapes):
    modes = spatial_modes(shapes["folded"].spring(), 7)
    kinds = kinds_of(shapes["folded"], modes.displacement, modes.rotation)
    assert kinds == ["bending", "breathing", "bending", "sideways", "breathing", "bending", "twist"]


def test_errors_of_strip_theory_mode_by_mode(summary):
    """Small form, on coarse meshes: plain -0.7 %, folded twice that, half of it from the bend as a plate."""
    found = summary["theory_error"]
    low = [row for row in found if row["family"] == "in plane" and row["number"] <= 3]
    folded = np.array([row["error"] for row in low if row["reading"] == "folded"])
    plain = np.array([row["error"] for row in low if row["reading"] == "plain"])
    plate = np.array([row["error_bend_as_plate"] for row in low if row["reading"] == "folded"])
    assert np.all((-0.009 < plain) & (plain < -0.006))
    assert np.all((-0.021 < folded) & (folded < -0.011))
    assert np.all((-0.010 < plate) & (plate < -0.004))
    assert all(abs(row["mesh_change"]) < 0.006 for row in low)
    twist = next(row for row in found if row["reading"] == "plain" and row["kind"] == "twist")
    assert -0.004 < twist["error"] < -0.002


def test_a_clamped_strip_is_between_strip_and_plate(summary, shapes):
    found = [row["stiffness_excess"] for row in summary["clamped_widths"]]
    assert np.all(np.diff([0.0, *found, plate_excess(shapes["plain"])]) > 0.0)


def test_the_verdict_follows_the_numbers_it_is_given(rows):
    usual = verdict_of(rows, [{"variation": "a", **row} for row in rows.values()], [])
    assert usual["default"] == "folded" and usual["variations_that_agree"] == ["a"]
    assert usual["plain_strip_is_higher"] and math.isnan(usual["channel_is_higher_from_sheet_m"])
    assert '"folded"' in verdict_words(rows, usual)
    other = {name: dict(row) for name, row in rows.items()}
    other["channel"]["ratio_twist"] = 40.0
    turned = verdict_of(other, [], [{**other["channel"]}])
    assert turned["default"] == "channel" and not turned["plain_strip_is_higher"]
    assert '"channel"' in verdict_words(other, turned)


def test_shapes_that_cannot_be_are_refused(scene):
    with pytest.raises(SceneError, match=r"bend_radius_m must be greater than half of spring\.width_m"):
        shape_of(scene.replace({"spring.width_m": 0.016}), "side_by_side")
    with pytest.raises(SceneError, match="no flange between"):
        brought_to(shape_of(scene, "channel"), 2.0 * math.pi * 5.0)


def test_the_net_moves_as_far_as_it_is_told(shapes):
    for name, across in (("folded", 5), ("channel", 7)):
        modes = spatial_modes(shapes[name].spring(), 8)
        rest, moved = net_of(shapes[name], modes, 0, 0.1)
        assert rest.shape == moved.shape and rest.shape[1:] == (across, 3)
        assert np.linalg.norm(moved - rest, axis=2).max() == pytest.approx(0.013, rel=1e-9)
        np.testing.assert_allclose(moved[0], rest[0], atol=1e-12)  # clamped


def test_the_files_and_the_summary(results, summary):
    for name in ("shapes", "theory_error", "channels", "clamped_widths"):
        assert (results / f"{name}.png").stat().st_size > 5000 and (results / f"{name}.pdf").exists()
    wanted = {"reading", "thickness_m", "flange_m", "first_bending_hz", "first_twist_or_sideways_hz", "ratio",
              "tip_value_twist", "tip_value_twist_off_line", "off_line_m"}
    assert [row["reading"] for row in summary["readings"]] == list(READINGS)
    assert all(wanted <= set(row) and row["off_line_m"] == 4e-4 for row in summary["readings"])
    assert {(row["reading"], row["family"]) for row in summary["theory_error"]} == {
        (name, family) for name in ("folded", "plain") for family in ("in plane", "out of plane")
    }
    assert summary["verdict"]["default"] == "folded" and summary["failed_cells"] == 0
    solids = {row["reading"]: row for row in summary["solids"]}
    assert abs(solids["channel"]["error_twist"]) < 0.01 and abs(solids["folded"]["error_twist"]) < 0.02
    with open(results / "readings.csv", newline="") as stream:
        assert [line["reading"] for line in csv.DictReader(stream)] == list(READINGS)


def test_the_figures_name_their_axes_with_units(results, summary):
    def columns(table):
        rows = summary[table]
        return {key: [math.nan if row[key] is None else row[key] for row in rows] for key in rows[0]}

    errors = draw_errors(columns("theory_error"))
    assert errors.axes[0].get_ylabel().endswith("(%)") and errors.axes[1].get_xlabel().endswith("(Hz)")
    left, right = draw_channels(columns("channels"), {"folded": 16.6}).axes
    assert left.get_xlabel().endswith("(mm)") and left.get_ylabel().endswith("(mm)") and right.get_ylabel()
    assert draw_widths(columns("clamped_widths"), 0.13).axes[0].get_ylabel().endswith("(%)")
    nets = dict(np.load(results / "shapes.npz"))
    panels = draw_shapes(nets, summary["readings"]).axes
    assert len(panels) == 4 and all(ax.get_aspect() == 1.0 for ax in panels)
    assert ["times the first bending" in ax.get_title(loc="left") for ax in panels] == [True] * 4


@pytest.mark.parametrize("text", ["0", "nan", "much"])
def test_a_distance_that_is_none_is_refused(text, capsys):
    assert main(["--off-line", text]) == 2
    assert "greater than 0" in capsys.readouterr().err
