"""Scenes: every key with unit and provenance, one sentence for whatever is wrong, nothing in between."""

import math
import pickle
import tomllib
import warnings
from dataclasses import FrozenInstanceError
from pathlib import Path

import letters_spring
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import beam
from beam import SuspiciousValue
from contact import NewtonRestitution
from studies.shell.scene import SCENES, Scene, SceneError, beam_at, check, hertz_of, model_of, read_scene
from studies.shell.scene.values import KEYS, parse_override, scene_from_text

DELIVERED = sorted(file.stem for file in SCENES.glob("*.toml"))


def refusal(*overrides: str, scene: str = "letter") -> str:
    """The sentence with which these values are refused."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousValue)
        with pytest.raises(SceneError) as caught:
            read_scene(scene, overrides)
    sentence = str(caught.value)
    assert sentence and "\n" not in sentence
    return sentence


def test_the_letters_scene_is_the_default():
    assert read_scene() == read_scene("letter") == read_scene(SCENES / "letter.toml")
    printed = {f"single_mode.{key}": value for key, value in vars(read_scene().single_mode).items()}
    assert read_scene() == Scene().replace(printed)


@pytest.mark.parametrize("modes", [letters_spring.FOLD_MODES, letters_spring.KICK_MODES])
def test_the_spring_of_the_tests_of_contact_is_the_letters(modes):
    """Its solver leaves up to 1e-8 of rounding in the first frequency, which the scene takes out."""
    scene = read_scene("letter", [f"modes.count={modes}"])
    plain, expected = letters_spring.letters_spring(modes), model_of(scene)
    for name in ("omega", "decay_rate", "phi", "participation", "static_compliance", "tip_mass"):
        assert getattr(plain, name) == pytest.approx(getattr(expected, name), rel=1e-7)
    assert letters_spring.HERTZ == hertz_of(scene) == beam_at(scene, 22.2).stop.law
    assert letters_spring.GAP == scene.stop.gap_m


def test_provenance_says_what_is_the_letters_and_what_was_fitted():
    provenance = read_scene().provenance()
    printed = {key for key, origin in provenance.items() if origin == "letter"}
    assert {"spring.leg_length_m", "drive.frequencies_hz", "single_mode.free_period_s"} <= printed
    fitted = {key for key, origin in provenance.items() if origin == "calibrated"}
    assert fitted == {"spring.thickness_m", "spring.tape_loss_factor", "tip.mass_kg", "stop.gap_m"}
    assert set(provenance.values()) == {"letter", "calibrated", "assumed"}
    scene = Scene().replace({"spring.thickness_m": 0.00061}, provenance="calibrated")
    scene = scene.replace({"spring.width_m": 0.011, "tip.mass_kg": Scene().tip.mass_kg})
    provenance = scene.provenance()
    assert provenance["spring.thickness_m"] == "calibrated" and provenance["spring.width_m"] == "given"
    assert provenance["tip.mass_kg"] == "calibrated"  # the value is still the default


@pytest.mark.parametrize("name", DELIVERED)
def test_every_scene_that_is_delivered_reads_without_doubt_and_dumps_to_itself(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error", SuspiciousValue)
        scene = read_scene(name)
    text = scene.dump()
    assert scene_from_text(text) == scene
    dumped = tomllib.loads(text)
    assert [f"{section}.{key}" for section in dumped for key in dumped[section]] == list(KEYS)


def test_a_dump_says_meaning_unit_default_and_provenance_of_every_key():
    lines = Scene().replace({"spring.width_m": 0.02}).dump().splitlines()
    for key, known in KEYS.items():
        name = key.partition(".")[2]
        places = [i for i, line in enumerate(lines) if line.startswith(f"{name} = ")]
        comments = [lines[i - 2 : i] for i in places]
        assert any(known.meaning in meaning and known.provenance in says for meaning, says in comments), key
        assert known.unit in ("", "1") or any(f"unit {known.unit}" in says for _, says in comments), key
    assert any("here given" in line for line in lines)


def test_scenes_are_values():
    scene = Scene().replace({"stop.gap_m": 0.012})
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert hash(scene) == hash(Scene().replace({"stop.gap_m": 0.012}))
    with pytest.raises(FrozenInstanceError):
        scene.stop.gap_m = 1.0  # type: ignore[misc]
    text = "[tip]\nrotary_inertia_kg_m2 = -0.0\n[spring]\ndensity_kg_m3 = 8500\n[scan]\npoints = 1e2"
    read = scene_from_text(text)
    assert math.copysign(1.0, read.tip.rotary_inertia_kg_m2) == 1.0
    assert isinstance(read.spring.density_kg_m3, float) and read.scan.points == 100


def test_reading_solves_no_eigenvalue_problem(monkeypatch):
    def never(*arguments, **named):
        raise AssertionError("modes were solved")

    monkeypatch.setattr(beam, "natural_modes", never)
    for name in DELIVERED:
        read_scene(name)


#: Section -> values outside of what makes sense; the sentence has to name the key.
WRONG_VALUES = {
    "spring": "width_m=-1 width_m=0 width_m=nan young_modulus_pa=-inf young_modulus_pa=true kind=folded_v "
    "thickness_m=0.013 young_modulus_pa=brass bend_radius_m=0.0003 bend_radius_m=0 leg_length_m=1e100 "
    "poisson_ratio=0.5 tape_sides=3 tape_coverage=1.5 tape_modulus_pa=0 tape_poisson_ratio=-1 "
    "tape_density_kg_m3=0 tape_thickness_m=-1e-4 density_kg_m3=0 loss_factor=-0.1 elements_per_leg=2.5 "
    "elements_on_arc=3000 leg_length_m=-0.1 young_modulus_pa=1" + "0" * 400,
    "tip": "mass_kg=-1 ball_radius_m=0 ball_poisson_ratio=0.6 ball_young_modulus_pa=-1 "
    "plate_poisson_ratio=-1 plate_young_modulus_pa=0 rotary_inertia_kg_m2=-1 arc_fraction=2",
    "readout": "arc_fraction=-0.1 quantity=colour",
    "damping": "kind=none decay_rate_per_s=-1 ratio=-1 measured_rates_per_s=3",
    "modes": "count=501 count=-1",
    "single_mode": "free_period_s=0 decay_rate_per_s=-2 restitution=1.5",
    "drive": "frequencies_hz=[] frequencies_hz=22.2 frequencies_hz=[22.2,0] frequencies_hz=[[22.2]]",
    "stop": "gap_m=0 gap_m=-0.01",
    "contact": "law=glue local_restitution=1.5 stiffness_n_per_m=-1 damping_ns_per_m=-1 "
    "dissipation_s_per_m=-1",
    "scan": "points=40.5 points=1 record_cycles=0 born_excess=0 largest_period=0 settle_cycles=inf",
    "modal_data": "tip_values=[1.0,inf]",
}
WRONG = [f"{section}.{value}" for section, values in WRONG_VALUES.items() for value in values.split()]


@pytest.mark.parametrize("override", WRONG)
def test_a_wrong_value_is_refused_with_its_key(override):
    key = override.partition("=")[0]
    assert key in refusal(override)


def test_a_refusal_gets_the_key_of_its_field():
    scene = Scene().replace({"spring.tape_thickness_m": 0.0, "spring.width_m": 1e-4})
    sheet = {"width": "spring.width_m", "thickness": "spring.thickness_m"}
    for made, keys in ((beam.StripSection, sheet), (beam.Layer, {"thickness": "spring.tape_thickness_m"})):
        with pytest.raises(SceneError) as caught:
            scene.make(made, keys, material=beam.BRASS)
        for error, field in ((caught.value, keys["thickness"]), (caught.value.__cause__, "thickness")):
            again = pickle.loads(pickle.dumps(error))
            assert again.field == field and str(again) == str(error) and str(error).startswith(f"{field} is ")


def test_a_bug_of_a_constructor_passes_as_itself():
    with pytest.raises(TypeError, match="unsupported operand"):
        Scene().make(lambda thickness: thickness + "m", {"thickness": "spring.thickness_m"})


TOGETHER = {
    "spring.tape_thickness_m=0": "spring.tape_thickness_m",
    "damping.kind=measured": "damping.measured_rates_per_s",
    "spring.kind=modal_data": "modal_data",
    "contact.law=linear tip.mass_kg=0": "contact.stiffness_n_per_m",
    "spring.kind=straight_strip spring.end_support=pinned": "tip.arc_fraction",
}


@pytest.mark.parametrize("overrides", TOGETHER)
def test_what_does_not_go_together_is_refused(overrides):
    assert TOGETHER[overrides] in refusal(*overrides.split())


UNKNOWN = {
    "spring.thicknes_m=1": "spring.thickness_m",
    "spring.mass_kg=1": "tip.mass_kg",
    "sprng.width_m=1": "spring.width_m",
    "stop.gap=1": "stop.gap_m",
    "scan.record_cycle=3": "scan.record_cycles",
}


@pytest.mark.parametrize("override", UNKNOWN)
def test_an_unknown_key_is_answered_with_the_nearest(override):
    nearest, (section, _, rest) = UNKNOWN[override], override.partition(".")
    assert refusal(override).endswith(nearest)
    with pytest.raises(SceneError, match=nearest.replace(".", r"\.") + "$"):
        scene_from_text(f"[{section}]\n{rest}")


@pytest.mark.parametrize(
    "text", ["[scans]\n", "gap_m = 0.01", "stop = 3", "[spring\nkind = 3", "a = " + "[" * 9999]
)
def test_a_text_that_is_no_scene_is_refused_in_one_line(text):
    with pytest.raises(SceneError) as caught:
        scene_from_text(text)
    assert "\n" not in str(caught.value)


@settings(max_examples=100, deadline=None)
@given(
    st.sampled_from(sorted(KEYS.keys() - {"modal_data.file"})),
    st.text() | st.floats() | st.integers() | st.lists(st.floats(), max_size=3),
)
def test_any_value_of_any_key_is_taken_or_refused(key, value):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousValue)
        try:
            scene = Scene().replace({key: value})
            check(scene)
        except SceneError as error:
            assert "\n" not in str(error)
        else:
            assert scene_from_text(scene.dump()) == scene


OVERRIDES = {
    "stop.gap_m = 1e-2 ": 0.01,
    "drive.frequencies_hz=[22.2, 23]": [22.2, 23],
    "spring.kind=cantilever": "cantilever",
    'spring.kind="cantilever"': "cantilever",
    "modal_data.file=a=b.csv": "a=b.csv",
    "spring.kind=1\n[stop]": "1\n[stop]",
}


def test_override_values_are_toml_or_bare_text_of_a_dotted_key():
    for text, value in OVERRIDES.items():
        assert parse_override(text) == (text.partition("=")[0].strip(), value)
    for text in ("stop.gap_m", "gap_m=1", "", "=", "stop.gap_m 3"):
        assert "section.key=value" in refusal(text)


def test_the_last_override_wins_and_no_drive_needs_no_gap():
    assert read_scene("letter", ["stop.gap_m=0.011", "stop.gap_m=0.012"]).stop.gap_m == 0.012
    assert read_scene("letter", ["drive.kind=none", "stop.gap_m=0"]).stop.gap_m == 0.0


FURTHER = {
    "gap_m = 0.012": "",
    'gap_m = 0.02\nside = 1\nat = "readout"\nlaw = "newton"\nlocal_restitution = 0.5': "",
    "gap = 0.012": "[[stops]] 1 has no key 'gap': the nearest is gap_m",
    "gap_m = 'wide'": "[[stops]] 1: gap_m must be a finite number",
    "gap_m = 0.01\nside = 0": "[[stops]] 1: side is 0 [1]; it must be +1 or -1",
    "gap_m = 0.01\nat = 'middle'": '[[stops]] 1: at must be one of "tip", "readout"',
    "gap_m = 0.011883925614219\nside = 1": "which lie at one place",
    "side = 1": "[[stops]] 1 has no gap_m",
    "gap_m = 0.01\nat = 'readout'": "[[stops]] 1: at is readout, whose quantity is a rotation",
}


@pytest.mark.parametrize("table", FURTHER)
def test_further_stops_are_read_dumped_or_refused(table, tmp_path: Path):
    own = tmp_path / "own.toml"
    own.write_text(f"{(SCENES / 'letter.toml').read_text()}\n[[stops]]\n{table}")
    if FURTHER[table]:
        assert FURTHER[table] in refusal("readout.quantity=rotation", scene=str(own))
        return
    scene = read_scene(own)
    assert scene_from_text(scene.dump()) == scene != scene.replace({"stops": []}) == read_scene()
    (plate, further), keys = beam_at(scene.replace({"modes.count": 3}), 22.2).stops, scene.stops[0]
    assert (further.gap, further.at, further.side) == (keys.gap_m, keys.at, keys.side)
    assert further.law == (NewtonRestitution(local_restitution=0.5) if keys.law == "newton" else plate.law)
    assert "cannot reach into [[stops]]" in refusal("stops.gap_m=0.01", scene=str(own))


def test_files_that_cannot_be_read(tmp_path: Path):
    (tmp_path / "latin.toml").write_bytes(b"# caf\xe9")
    for name in (tmp_path / "latin.toml", tmp_path / "absent.toml", tmp_path):
        assert str(name)[:20] in refusal(scene=str(name))
    assert "letter" in refusal(scene="lettre")
