"""The scene reader: one table of keys, one sentence for whatever is wrong, and never anything in between."""

from __future__ import annotations

import math
import pickle
import tomllib
import warnings
from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest

from beam import SuspiciousValue
from studies.instruments.plausibility import suspicions
from studies.instruments.quantities import SceneError
from studies.instruments.scene import MODE_LISTS, Scene, keys, scene_of
from studies.instruments.scene_fields import SpringKeys
from studies.instruments.scene_file import SCENES, dump_scene, parse_override, read_scene, scene_from_text

KEYS = [key for key, _, _ in keys()]
LETTER_TEXT = (SCENES / "letter.toml").read_text()


def complaint(*overrides: str, text: str = "") -> str:
    with pytest.raises(SceneError) as caught:
        scene_from_text(text, overrides=overrides)
    sentence = str(caught.value)
    assert sentence and "\n" not in sentence
    return sentence


def test_the_letters_scene_is_the_default():
    assert read_scene() == read_scene("letter") == read_scene(SCENES / "letter.toml") == Scene()


def test_the_letters_numbers_are_marked_as_such():
    provenance = Scene().provenance()
    printed = {key for key, origin in provenance.items() if origin == "letter"}
    assert {"spring.leg_length_m", "drive.frequencies_hz", "single_mode.free_period_s"} <= printed
    fitted = {key for key, origin in provenance.items() if origin == "calibrated"}
    assert fitted == {"spring.thickness_m", "spring.tape_loss_factor", "tip.mass_kg", "stop.gap_m"}
    assert set(provenance.values()) == {"letter", "calibrated", "assumed"}


@pytest.mark.parametrize("name", sorted(file.stem for file in SCENES.glob("*.toml")))
def test_every_scene_that_comes_with_the_studies_reads(name):
    scene = read_scene(name)
    assert scene_from_text(dump_scene(scene)) == scene


def test_dump_shows_every_key_with_default_and_provenance():
    scene = Scene().replace({"spring.width_m": 0.02, "drive.frequencies_hz": [19.65]})
    text = dump_scene(scene)
    assert scene_from_text(text) == scene
    dumped = tomllib.loads(text)
    assert [f"{section}.{name}" for section in dumped for name in dumped[section]] == KEYS
    assert "(unit m); default 0.012, assumed; here given\nwidth_m = 0.02\n" in text
    assert "(unit m); default 0.13, letter\nleg_length_m = 0.13\n" in text


def test_every_key_can_be_set_to_its_own_value():
    scene = Scene()
    for key in KEYS:
        assert scene.replace({key: scene[key]}) == scene


def test_replace_keeps_track_of_provenance():
    scene = Scene().replace({"spring.thickness_m": 0.00061}, provenance="calibrated")
    scene = scene.replace({"spring.width_m": 0.011, "tip.mass_kg": Scene().tip.mass_kg})
    provenance = scene.provenance()
    assert provenance["spring.thickness_m"] == "calibrated"
    assert provenance["spring.width_m"] == "given"
    assert provenance["tip.mass_kg"] == "calibrated"  # the value is still the default
    assert Scene().spring.thickness_m == 0.00069683709067


def test_scenes_are_values():
    scene = Scene().replace({"stop.gap_m": 0.012})
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert scene_of(scene.as_dict()) == scene
    assert hash(scene_of(scene.as_dict())) == hash(scene)
    assert scene.fingerprint() == scene_of(scene.as_dict()).fingerprint() != Scene().fingerprint()
    with pytest.raises(FrozenInstanceError):
        scene.stop.gap_m = 1.0  # type: ignore[misc]


def test_whole_numbers_become_floats_and_minus_zero_is_zero():
    scene = scene_from_text("[tip]\nrotary_inertia_kg_m2 = -0.0\n[spring]\ndensity_kg_m3 = 8500")
    assert math.copysign(1.0, scene.tip.rotary_inertia_kg_m2) == 1.0
    assert isinstance(scene.spring.density_kg_m3, float)
    assert scene.fingerprint() == Scene().fingerprint()
    assert scene_from_text("[scan]\npoints = 1e2").scan.points == 100


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("spring.width_m=-1", ["spring.width_m", "-1", "unit m", "greater than 0"]),
        ("spring.width_m=0", ["spring.width_m", "not 0"]),
        ("spring.width_m=nan", ["spring.width_m", "finite", "not nan"]),
        ("spring.young_modulus_pa=-inf", ["unit Pa", "-inf"]),
        ("spring.young_modulus_pa=inf", ["unit Pa", "not inf"]),
        ("modal_data.tip_values=[1.0, inf]", ["finite", "inf"]),
        ("spring.young_modulus_pa=true", ["spring.young_modulus_pa", "not True"]),
        ("spring.young_modulus_pa=brass", ["spring.young_modulus_pa", "'brass'"]),
        ("spring.young_modulus_pa=1" + "0" * 400, ["spring.young_modulus_pa", "..."]),
        ("tip.ball_poisson_ratio=0.5", ["less than 0.5", "dimensionless"]),
        ("spring.kind=folded_v", ['"folded_u"', "'folded_v'"]),
        ("scan.points=40.5", ["whole number", "40.5"]),
        ("scan.points=inf", ["whole number", "inf"]),
        ("drive.frequencies_hz=[]", ["at least one", "unit Hz", "not []"]),
        ("drive.frequencies_hz=22.2", ["a list", "22.2"]),
        ("drive.frequencies_hz=[22.2, 0]", ["each greater than 0"]),
        ("drive.frequencies_hz=[[22.2]]", ["a list", "[[22.2]]"]),
        ("stop.gap_m=0", ["stop.gap_m", "greater than 0", "drive"]),
        ("spring.bend_radius_m=0.0003", ["spring.bend_radius_m", "spring.thickness_m"]),
        ("spring.tape_thickness_m=0", ["strips", "spring.tape_thickness_m"]),
        ("damping.kind=measured", ["damping.measured_rates_per_s", "for each mode, 1"]),
        ("spring.kind=modal_data", ["modal_data", "equal length"]),
    ],
)
def test_a_wrong_value_is_named_with_unit_and_what_is_valid(override, words):
    sentence = complaint(override)
    for word in words:
        assert word in sentence


@pytest.mark.parametrize(
    ("override", "nearest"),
    [
        ("spring.thicknes_m=1", "spring.thickness_m"),
        ("spring.mass_kg=1", "tip.mass_kg"),
        ("sprng.width_m=1", "spring.width_m"),
        ("stop.gap=1", "stop.gap_m"),
        ("scan.record_cycle=3", "scan.record_cycles"),
    ],
)
def test_an_unknown_key_is_answered_with_the_nearest(override, nearest):
    assert complaint(override).endswith(f"the nearest valid key is {nearest}")
    section, _, rest = override.partition(".")
    assert complaint(text=f"[{section}]\n{rest}").endswith(f"the nearest valid key is {nearest}")


def test_unknown_sections_and_stray_keys():
    assert "[scan]" in complaint(text="[scans]\n")
    assert "stop.gap_m" in complaint(text="gap_m = 0.01")
    assert "stop must be a section" in complaint(text="stop = 3")
    assert "stop must be a section" in complaint("stop.gap_m=0.01", text="stop = 3")


def test_no_drive_needs_no_gap():
    assert scene_from_text('[drive]\nkind = "none"\n[stop]\ngap_m = 0').stop.gap_m == 0.0


def test_a_drive_above_the_modes_is_refused():
    Scene().refuse_drive_above(23.41)
    with pytest.raises(SceneError, match=r"23\.4 Hz.*23\.39 Hz"):
        Scene().refuse_drive_above(23.39)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("stop.gap_m=0.011", 0.011),
        ("stop.gap_m = 1e-2 ", 0.01),
        ("drive.frequencies_hz=[22.2, 23]", [22.2, 23]),
        ("spring.kind=cantilever", "cantilever"),
        ('spring.kind="cantilever"', "cantilever"),
        ("modal_data.file=a=b.csv", "a=b.csv"),
        ("spring.kind=1\n[stop]", "1\n[stop]"),
        ("spring.kind=", ""),
    ],
)
def test_override_values_are_toml_or_bare_text(text, value):
    assert parse_override(text) == (text.partition("=")[0].strip(), value)


@pytest.mark.parametrize("text", ["stop.gap_m", "gap_m=1", "", "=", "stop.gap_m 3"])
def test_an_override_needs_a_dotted_key_and_a_value(text):
    assert "section.key=value" in complaint(text)


def test_the_last_override_wins():
    assert read_scene("letter", ["stop.gap_m=0.011", "stop.gap_m=0.012"]).stop.gap_m == 0.012


def test_files_that_cannot_be_read(tmp_path: Path):
    (tmp_path / "latin.toml").write_bytes(b"# caf\xe9")
    (tmp_path / "broken.toml").write_text("[spring\nkind = 3")
    (tmp_path / "deep.toml").write_text("a = " + "[" * 100_000)
    for name in ("latin.toml", "broken.toml", "deep.toml", "absent.toml", "."):
        with pytest.raises(SceneError, match=r"^the scene '") as caught:
            read_scene(tmp_path / name)
        assert "\n" not in str(caught.value)
    with pytest.raises(SceneError, match=r"one of .*letter"):
        read_scene("lettre")


MODES = """participation, tip_values, frequencies_hz, decay_rates_per_s
# mode 1
0.11,8.2,24.5,3.56

0.06,-7,149,20
"""


def test_measured_modes_from_a_file_beside_the_scene(tmp_path: Path):
    (tmp_path / "modes.csv").write_text(MODES)
    scene_file = tmp_path / "own.toml"
    scene_file.write_text('[spring]\nkind = "modal_data"\n[modal_data]\nfile = "modes.csv"\n')
    scene = read_scene(scene_file)
    assert scene.modal_data.frequencies_hz == (24.5, 149.0)
    assert scene.modal_data.tip_values == (8.2, -7.0)
    assert scene.modal_data.file == ""  # the scene has become independent of the file
    overrides = ["spring.kind=modal_data", f"modal_data.file={tmp_path / 'modes.csv'}"]
    assert read_scene("letter", overrides) == scene
    with pytest.raises(SceneError, match="twice"):
        read_scene(scene_file, ["modal_data.tip_values=[1.0]"])
    with pytest.raises(SceneError, match="150 Hz, above the highest of the modes kept"):
        read_scene(scene_file, ["drive.frequencies_hz=[150]"])
    with pytest.raises(SceneError, match="30 Hz, above the highest of the modes kept"):
        read_scene(scene_file, ["drive.frequencies_hz=[30]", "modes.count=1"])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "heading"),
        ("frequencies_hz,tip_values\n", "heading"),
        (",".join(MODE_LISTS) + "\n1,2,3\n", "3 values, not 4, for mode 1"),
        (",".join(MODE_LISTS) + "\n1,2,three,4\n", "'three', which is not a number, for tip_values"),
        (",".join(MODE_LISTS) + "\n1,2,nan,4\n", "modal_data.tip_values"),
        (",".join(MODE_LISTS) + "\n", "equal length"),
    ],
)
def test_measured_modes_that_are_wrong(tmp_path: Path, content: str, words: str):
    path = tmp_path / "modes.csv"
    path.write_text(content)
    with pytest.raises(SceneError) as caught:
        read_scene("letter", ["spring.kind=modal_data", f"modal_data.file={path}"])
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_lists_of_modes_must_match():
    lists = "[spring]\nkind = 'modal_data'\n[modal_data]\nfrequencies_hz = [24.5, 149]\n"
    assert "frequencies_hz with 2" in complaint(text=lists + "decay_rates_per_s = [3.56]")


def test_sections_check_themselves():
    with pytest.raises(SceneError, match=r"spring\.width_m"):
        SpringKeys(width_m=-1.0)
    with pytest.raises(TypeError, match="section stop"):
        Scene(stop=SpringKeys())  # type: ignore[arg-type]


@pytest.mark.parametrize("name", sorted(file.stem for file in SCENES.glob("*.toml")))
def test_no_scene_that_comes_with_the_studies_is_suspicious(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error", SuspiciousValue)
        read_scene(name)


#: A slip of a unit or a value beyond the theory, and what the warning says.
SLIPS = {
    "stop.gap_m=10.7": "more than the length of the spring",
    "stop.gap_m=0.02": "the theory is that of small motion",
    "spring.leg_length_m=130": "hangs under its own weight",
    "spring.width_m=12": "spring.width_m is 12 m",
    "spring.thickness_m=0.006": "a bar rather than a strip",
    "spring.bend_radius_m=7.5": "spring.bend_radius_m is 7.5 m",
    "spring.young_modulus_pa=105": "speed of sound of 0.111 m/s",
    "spring.density_kg_m3=8.5": "speed of sound",
    "spring.tape_modulus_pa=1": "speed of sound",
    "spring.tape_thickness_m=0.45": "thickness is 0.45",
    "spring.tape_loss_factor=49": "materials stay below 3",
    "tip.mass_kg=6.16": "heavier than the strip",
    "tip.ball_radius_m=2.5": "tip.ball_radius_m is 2.5 m",
    "tip.ball_young_modulus_pa=370": "youngs_modulus is 370 Pa",
    "tip.plate_young_modulus_pa=210e3": "other_modulus is 210000 Pa",
    "drive.frequencies_hz=[0.0222]": "0.000906 times the first mode",
    "drive.frequencies_hz=[22.2, 139.5]": "has 139.5 Hz, 5.69 times the first mode",
    "single_mode.free_period_s=1": "1 Hz by single_mode.free_period_s",
    "single_mode.free_period_s=40.8": "damping ratio of 11.6",
    "single_mode.decay_rate_per_s=3560": "damping ratio of 11.6",
    "damping.decay_rate_per_s=3560": "damping ratio of 11.6",
    "scan.born_excess=1": "far from grazing",
    "spring.width_m=0.010": "map and Eq. (1) describe another spring",
    "tip.mass_kg=0.004": "map and Eq. (1) describe another spring",
}


@pytest.mark.parametrize("override", SLIPS)
def test_a_slip_of_a_unit_is_taken_with_a_warning_that_says_why(override):
    with pytest.warns(SuspiciousValue) as found:
        scene = read_scene("letter", [override])
    assert scene == read_scene_quietly(override)
    sentences = [str(warning.message) for warning in found]
    assert any(SLIPS[override] in sentence for sentence in sentences), sentences
    assert len(sentences) <= 3 and len(set(sentences)) == len(sentences)
    assert all(warning.filename == __file__ for warning in found)


def read_scene_quietly(override):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousValue)
        return read_scene("letter", [override])


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["damping.kind=constant_ratio", "damping.ratio=1.16"], "damping.ratio makes a damping ratio"),
        (["damping.kind=constant_loss_factor", "damping.loss_factor=2.3"], "damping.loss_factor makes"),
        (["damping.kind=rayleigh", "damping.rayleigh_beta_s=0.1"], "damping.rayleigh_beta_s makes"),
        (["contact.law=linear", "contact.stiffness_n_per_m=1000"], "a second spring, no stop"),
    ],
)
def test_other_laws_are_judged_by_their_own_numbers(overrides, words):
    scene = Scene().replace({key: value for key, value in map(parse_override, overrides)})
    assert any(words in sentence for sentence in suspicions(scene))
