"""One approach to the plate: limits of restitution, delay and kick, the reading of the curves, the study."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from contact.laws import HuntCrossley, LinearContact, NewtonRestitution
from studies import effective_impact
from studies.instruments.calibration import free_period
from studies.instruments.effective_impact.answers import (
    clusters,
    fade,
    hard_stop,
    stands_still,
    worst_of_closed_forms,
)
from studies.instruments.effective_impact.approaches import Approach, measure, measure_all, select
from studies.instruments.effective_impact.curves import contacts
from studies.instruments.effective_impact.restitution import (
    crossing,
    floor_over_mass,
    local_loss,
    settled_orbits,
)
from studies.instruments.effective_impact.specimen import Specimen
from studies.instruments.oscillators import beam_of
from studies.instruments.scene_file import read_scene
from studies.instruments.tip_mass_family import bare_cantilever, leaf_mass, with_mass_ratio
from studies.published import TIME_TRACE_EXCESS

COARSE = {"spring.elements_per_leg": 20, "spring.elements_on_arc": 12}
LETTER = read_scene("letter").replace(COARSE)
FREQUENCY = 22.2


@pytest.fixture(scope="module")
def scene():
    """The letter's spring with 20 modes."""
    return Specimen.of(LETTER, FREQUENCY, 20)


@pytest.fixture(scope="module")
def bare():
    """A cantilever without ball, on a mesh that bears 25 modes."""
    fine = LETTER.replace({"spring.elements_per_leg": 50})
    return Specimen.of(bare_cantilever(fine, FREQUENCY), FREQUENCY, 25)


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """The quick form of the study on a coarse mesh, and its folder."""
    out = tmp_path_factory.mktemp("impact")
    sets = [word for key, value in COARSE.items() for word in ("--set", f"{key}={value}")]
    assert effective_impact.main(["--quick", "--out", str(out), *sets]) == 0
    folder = out / "effective_impact"
    return json.loads((folder / "summary.json").read_text()), folder


def met(specimen, law, excess=TIME_TRACE_EXCESS, modes=None, **more):
    """The row of one approach."""
    model = specimen.model if modes is None else specimen.model.truncated(modes)
    row = measure(
        Approach(
            curve="test", series="a", varied="excess", value=excess, excess=excess,
            oscillator=specimen.with_law(law, model), **more,
        )
    )
    assert row["failure"] == ""
    return row


# the physics of one collision


@pytest.mark.parametrize("e", [1.0, 0.6, 0.1])
def test_one_mode_under_newtons_law_has_the_laws_restitution_and_no_delay(scene, e):
    row = met(scene, NewtonRestitution(local_restitution=e), modes=1)
    assert row["restitution"] == pytest.approx(e, abs=1e-9)
    assert row["kick"] == pytest.approx(1.0 + e, abs=1e-9)
    assert row["delay_s"] == pytest.approx(0.0, abs=1e-12)
    assert row["energy_to_higher_modes"] == 0.0


@pytest.mark.parametrize("modes", [2, 5, 10])
def test_the_kick_under_newtons_law_is_that_of_the_modal_masses(scene, modes):
    e = 0.7
    phi = scene.model.phi[:modes]
    row = met(scene, NewtonRestitution(local_restitution=e), modes=modes)
    # (1 + e) r_N, r_N = phi_1^2 / sum phi_k^2, with the higher modes all but at rest
    assert row["impacts"] == 1
    assert row["kick"] == pytest.approx((1.0 + e) * phi[0] ** 2 / np.sum(phi**2), rel=2e-3)
    assert row["restitution"] == pytest.approx(abs(1.0 - row["kick"]), abs=2e-3)


def test_restitution_and_delay_follow_from_kick_and_shift(scene):
    laws = [scene.hertz, LinearContact(stiffness=1e5), scene.lossy(0.4, TIME_TRACE_EXCESS)]
    rows = [met(scene, law, excess) for law in laws for excess in (1e-3, 0.013, 0.05)]
    assert worst_of_closed_forms(rows)["collisions"] == 9
    assert worst_of_closed_forms(rows)["restitution"] < 3e-3
    assert worst_of_closed_forms(rows)["delay_over_arc"] < 1e-2


def test_the_floor_of_restitution_is_the_time_of_the_contact(scene):
    row = met(scene, scene.hertz)
    assert row["kick"] == pytest.approx(1.0, abs=0.02)
    assert row["restitution"] == pytest.approx(math.sqrt(row["contact_s"] / row["arc_s"]), rel=0.03)
    harder = met(scene, scene.as_hard_as(9.0, TIME_TRACE_EXCESS))
    as_hard = met(scene, scene.as_hard_as(1.0, TIME_TRACE_EXCESS))
    assert harder["contact_s"] == pytest.approx(as_hard["contact_s"] / 3.0, rel=0.05)
    assert harder["restitution"] < 0.65 * as_hard["restitution"]


def test_energy_goes_where_it_is_said_to_go(scene):
    elastic, lossy = met(scene, scene.hertz), met(scene, scene.lossy(0.3, TIME_TRACE_EXCESS))
    assert elastic["energy_lost"] == pytest.approx(0.0, abs=1e-12)
    # kick 1 takes all of mode 1: the higher modes have it, 1 - restitution^2 within the work of the spring
    assert elastic["energy_share"] == pytest.approx(1.0 - elastic["restitution"] ** 2, abs=0.02)
    assert lossy["energy_lost"] > 0.0 and lossy["energy_share"] < elastic["energy_share"]


def test_a_bare_tip_keeps_seven_tenths_and_is_late_by_more_than_the_arc(bare):
    row = met(bare, bare.hertz)
    assert row["restitution"] == pytest.approx(0.7, abs=0.02)
    assert row["delay_s"] > row["arc_s"]
    assert row["impacts"] > 1
    many = met(bare, NewtonRestitution(local_restitution=1.0))
    few = met(bare, NewtonRestitution(local_restitution=1.0), modes=10)
    assert many["impacts"] > 3 * few["impacts"]
    assert many["restitution"] == pytest.approx(few["restitution"], abs=0.02)


def test_the_kick_fades_where_the_contact_outlasts_the_arc(scene):
    kicks = [met(scene, scene.hertz, excess)["kick"] for excess in (1e-5, 1e-4, 1e-3, 1e-2)]
    assert kicks == sorted(kicks)
    assert kicks[0] < 0.15 and kicks[-1] > 0.95


def test_twenty_modes_are_enough_from_a_tenth_of_the_leaf_on(scene):
    rows = [met(scene, scene.hertz, modes=n) for n in (5, 10, 18, 20)]
    tau = [abs(row["kick"] - rows[-1]["kick"]) for row in rows]
    assert tau[0] < 0.18 and tau[1] < 0.04 and tau[2] < 1e-3


# the family of tip masses


def test_the_family_keeps_period_and_amplitude_at_grazing():
    fitted = with_mass_ratio(LETTER, 0.2, FREQUENCY)
    assert fitted.tip.mass_kg == pytest.approx(0.2 * leaf_mass(fitted), rel=1e-9)
    assert free_period(fitted) == pytest.approx(40.80e-3, rel=1e-8)
    assert beam_of(fitted, FREQUENCY).grazing_amplitude() == pytest.approx(2e-3, rel=1e-9)
    keys = fitted.spring
    sheet = keys.thickness_m * keys.density_kg_m3 * (2 * keys.leg_length_m + math.pi * keys.bend_radius_m)
    tape = keys.tape_thickness_m * keys.tape_density_kg_m3 * 2 * keys.leg_length_m
    assert leaf_mass(fitted) == pytest.approx(keys.width_m * (sheet + tape), rel=1e-9)


# reading the curves, with planted rows


def planted(curve, series, values, **columns):
    """Rows of a curve with these columns."""
    return [
        {"curve": curve, "series": series, "value": v, "failure": "", "impacts": 1}
        | {name: column[i] for name, column in columns.items()}
        for i, v in enumerate(values)
    ]


def test_crossings_are_found_in_the_logarithm():
    x = np.geomspace(1e-5, 1.0, 11)
    assert crossing(x.tolist(), np.log10(x).tolist(), -2.25) == pytest.approx(10**-2.25, rel=1e-9)
    assert math.isnan(crossing(x.tolist(), np.log10(x).tolist(), 1.0))
    assert math.isnan(crossing([1.0], [1.0], 0.5))


def test_a_planted_fade_is_read_back():
    excess = np.geomspace(1e-6, 0.1, 41)
    rows = planted("speed", "a", excess.tolist(), excess=excess, kick=1.2 * excess / (excess + 5e-5))
    found = fade(rows, 2.5e-4, 1e-3)
    assert found["plateau"] == pytest.approx(1.2, rel=1e-3)
    assert found["half_excess"] == pytest.approx(5e-5, rel=5e-3)
    assert found["share_at_resolution"] == pytest.approx(2.5e-4 / 3e-4, rel=2e-3)
    rising = planted("speed", "a", excess.tolist(), excess=excess, kick=excess)
    assert math.isnan(fade(rising, 2.5e-4, 1e-3)["half_excess"])


def mode_rows(restitution, beyond):
    counts = [*range(1, 41), 60]
    value = [restitution(n) for n in counts[:-1]] + [beyond]
    same = [1e-3] * 41
    return planted(
        "modes", "a", counts, modes=counts, restitution=value, kick=value, delay_s=same, arc_s=same
    )


def test_what_stands_still_is_told_from_what_drifts():
    settled = stands_still(mode_rows(lambda n: 0.2 + math.exp(-0.5 * n), 0.2), 40)
    assert settled["modes"] == math.ceil(2 * math.log(1e3))
    drifting = stands_still(mode_rows(lambda n: 1.0 / n, 1.0 / 60), 40)
    assert drifting["modes"] is None and drifting["drift"] == pytest.approx(1 / 40 - 1 / 60)
    assert stands_still([], 40)["modes"] is None


def family(kick_slope, floor, ratios=(0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 1.0)):
    kick = [1.0 + kick_slope * math.log(r / 0.25) for r in ratios]
    tau = [math.sqrt((1.0 - k) ** 2 + floor**2) for k in kick]
    return ratios, kick, tau


def search_rows(floors):
    rows = []
    for e, floor in floors.items():
        ratios, kick, tau = family(0.5, floor)
        rows += planted(
            "search", f"{e:g}", ratios, mass_ratio=ratios, kick=kick, restitution=tau, arc_s=[1e-3] * len(tau)
        )
    return rows


def test_the_smallest_restitution_lies_between_the_cells():
    ratios, kick, tau = family(0.5, 0.08)
    rows = planted("search", "1", ratios, mass_ratio=ratios, kick=kick, restitution=tau)
    found = floor_over_mass(rows, 0.1)
    assert found["restitution"] == pytest.approx(0.08, abs=1e-4)
    assert found["mass_ratio"] == pytest.approx(0.25, rel=0.01)
    # (1 - kick)^2 = 0.1^2 - 0.08^2 on either side
    assert found["at_target"] == pytest.approx([0.25 * math.exp(-0.12), 0.25 * math.exp(0.12)], rel=0.01)
    assert math.isnan(floor_over_mass([], 0.1)["restitution"])


@pytest.mark.parametrize(
    ("floors", "verdict"),
    [
        ({1.0: 0.05, 0.5: 0.05}, "reached without local loss"),
        ({1.0: 0.2, 0.5: 0.05}, "reached with local loss only"),
        ({1.0: 0.2, 0.5: 0.2}, "not reached, with or without local loss"),
    ],
)
def test_the_verdict_on_local_loss(floors, verdict):
    found = local_loss(search_rows(floors), 0.1)
    assert found["verdict"] == verdict
    assert found["contact_time_needed_s"] == pytest.approx(1e-5)


def test_an_orbit_that_does_not_return_counts_as_no_restitution():
    rows = planted(
        "orbit", "a", (0.1, 0.2, 0.3, 0.4), mass_ratio=(0.1, 0.2, 0.3, 0.4), orbit_period=(4, 4, 4, 0),
        approach_velocity=[0.9] * 4, kick=[1.0] * 4, force_delay_s=[0.0] * 4,
        restitution=(0.3, math.nan, 0.05, 0.02), returns=(True, False, True, True),
        forced_by_ringing=[False] * 4,
    )
    found = settled_orbits(rows, 0.1)
    assert found["reached"] and found["mass_ratios_below_target"] == [0.2, 0.3]


def test_clusters_are_found_where_they_begin():
    rows = planted("speed", "bare", (1e-3, 1e-2, 1e-1), excess=(1e-3, 1e-2, 1e-1))
    rows[1]["impacts"] = rows[2]["impacts"] = 3
    rows += planted("mass", "excess 0.01", (0.0, 0.1), mass_ratio=(0.0, 0.1), excess=(0.01, 0.01))
    rows[3]["impacts"] = 2
    found = clusters(rows)
    assert found["first_excess"] == {"bare": 1e-2}
    assert found["heaviest_mass_ratio"] == {"excess 0.01": 0.0}
    assert found["first_excess_by_mass_ratio"] == {"0": 0.01, "0.1": None}
    assert math.isnan(hard_stop([])["kick"])


def test_a_failed_cell_is_kept_as_such(scene):
    # below grazing the tip never reaches the plate
    cell = Approach(
        curve="speed", series="a", varied="excess", value=-0.1, excess=-0.1,
        oscillator=scene.with_law(scene.hertz),
    )
    rows = measure_all([cell, replace(cell, value=0.01, excess=0.01)], workers=2)
    assert "no collision" in rows[0]["failure"] and rows[1]["failure"] == ""
    assert math.isnan(rows[0]["kick"]) and rows[0].keys() == rows[1].keys()
    assert [row["value"] for row in select(rows, "speed")] == [0.01]


def test_hunt_crossley_has_its_restitution_on_a_free_mass(scene):
    law = scene.lossy(0.5, TIME_TRACE_EXCESS)
    assert isinstance(law, HuntCrossley)
    a, b = (law.dissipation * factor * scene.speed(TIME_TRACE_EXCESS) for factor in (1.0, 0.5))
    assert a - math.log1p(a) == pytest.approx(-b - math.log1p(-b), rel=1e-9)


def test_a_contact_of_the_scene_that_is_hertzs_is_one_curve(scene):
    assert [name for name, _specimen, _law in contacts(scene)] == ["hertz"]
    linear = replace(scene, scene=LETTER.replace({"contact.law": "linear"}))
    own, hertz = contacts(linear)
    assert (own[0], hertz[0]) == ("scene", "hertz") and isinstance(own[2], LinearContact)


def test_a_law_of_any_type_has_a_row(scene):
    """Also one that no table lists."""

    class Harder(LinearContact):
        pass

    assert met(scene, Harder(stiffness=1e6))["law"] == "Harder"


# the study


def test_the_summary_has_its_rows_and_answers(quick):
    summary, _ = quick
    assert (summary["schema"], summary["failed_cells"], summary["failures"]) == (1, 0, [])
    wanted = {
        "curve", "varied", "value", "excess", "approach_velocity", "modes", "tip_mass", "law", "restitution",
        "delay_s", "kick", "shift_m", "impacts", "contact_s", "energy_to_higher_modes",
    }
    assert all(wanted <= row.keys() for row in summary["rows"])
    curves = {row["curve"] for row in summary["rows"]}
    assert curves == {
        "speed", "modes", "mass", "orbit", "stiffness", "materials", "damping", "loss", "search", "hardness"
    }
    assert summary["frequency_hz"] == 22.2


def test_the_answers_agree_with_what_is_known(quick):
    answers = quick[0]["answers"]
    loss = answers["local_loss"]
    assert loss["verdict"] == "not reached, with or without local loss"
    assert 0.2 < loss["elastic_floor"] < 0.24 and 0.2 < loss["lossy_floor"] < 0.24
    assert 20.0 < loss["hardness_needed"] < 45.0
    assert 0.15 < loss["excess_needed"] < 0.25
    assert 0.2 < answers["smallest_restitution"]["mass_ratio"] < 0.3
    assert 3e-5 < answers["fade"]["hertz"]["half_excess"] < 8e-5
    assert set(answers["fade"]) == {"hertz", "bare tip"}
    assert answers["closed_forms"]["restitution"] < 3e-3
    assert 0.2 < answers["reference"]["delay_over_arc"] < 0.27
    assert answers["modes"]["hertz"]["modes"] <= 20
    assert answers["modes"]["newton"]["modes"] is None
    assert answers["modes"]["bare cantilever, newton"]["modes"] is None
    assert answers["amplitude_resolution"] == pytest.approx(2.5e-4)


def test_table_and_figures_are_written(quick):
    summary, folder = quick
    names = {file.name for file in folder.iterdir()}
    assert {f"{name}.{kind}" for name in ("speed", "mass", "search") for kind in ("png", "pdf")} <= names
    with (folder / "collisions.csv").open(newline="") as file:
        table = list(csv.DictReader(file))
    assert len(table) == len(summary["rows"])
    assert float(table[0]["kick"]) == pytest.approx(summary["rows"][0]["kick"], rel=1e-12)


@pytest.mark.parametrize(
    "wrong",
    [("contact.law=foo",), ("drive.kind=none",), ("stop.gap_m=-1",),
     ("spring.kind=modal_data", "modal_data.frequencies_hz=[24.5]", "modal_data.decay_rates_per_s=[3.56]",
      "modal_data.tip_values=[8.0]", "modal_data.participation=[0.1]")],
)
def test_wrong_use_is_refused_in_one_sentence(tmp_path, capsys, wrong):
    argv = ["--quick", "--out", str(tmp_path)]
    assert effective_impact.main([*argv, *(word for key in wrong for word in ("--set", key))]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and told.startswith("python -m studies.effective_impact: ")
