"""Measured modes of a scene: each description gives one model, and a wrong file is refused with the place."""

import math
from pathlib import Path

import pytest

from studies.shell.scene import Scene, SceneError, model_of, read_scene
from studies.shell.scene.keys import MODE_LISTS
from studies.shell.scene.values import scene_from_text


def refusal(*overrides: str, scene: str) -> str:
    """The sentence with which these values are refused."""
    with pytest.raises(SceneError) as caught:
        read_scene(scene, overrides)
    return str(caught.value)


FOUR, ROW = ",".join(MODE_LISTS), "24.5,3.56,8.2,0.11"
WRONG_FILES = {
    "": "it needs a heading, and below it a line of numbers",
    FOUR: "it needs a heading, and below it a line of numbers",
    f"{FOUR}\n{ROW}\n1,2,3": "line 3 has 3 cells separated by commas, and the heading has 4",
    f"{FOUR}\n#\n\n1,2,three,4": "line 4, column tip_values: 'three' is no number",
    f"{FOUR}\n1,2,nan,4": "line 2, column tip_values: 'nan' is no number",
    f"{FOUR}\n{ROW}\n1,2,3,4".replace(",", ";").replace("3;4", "7,6;4"): "column tip_values: '7,6' is no",
    f"{FOUR[:-14]}\n1,2,3".replace(",", ";"): "it has no participation; its heading is frequencies_hz, ",
    f"{FOUR[:-14]}\n1;2;3".replace(",", ";"): "separated by semicolons",
    f"{FOUR}\n1 2 3 4".replace(",", " "): "without comma, semicolon or tab",
    f"{FOUR},damping_ratios\n1,2,3,4,5": "it has decay_rates_per_s and damping_ratios",
    "frequencies_hz,tip_values,participation\n1,2,3": "it has no decay_rates_per_s (or else damping_ratios)",
    "frequencies_hz,damping_ratios,base_residues_re\n1,2,3": "it has no force_residues_re, ",
    "\xff": "it is not text in UTF-8",
}


def measured(folder: Path, heading: str, rows: str, *overrides: str) -> Scene:
    """The scene with a file of measured modes with these lines."""
    (folder / "modes.csv").write_bytes(f"{heading}\n{rows}".encode())
    (folder / "own.toml").write_text('[spring]\nkind = "modal_data"\n[modal_data]\nfile = "modes.csv"\n')
    return read_scene(folder / "own.toml", overrides)


def test_each_description_of_measured_modes_gives_the_same_model(tmp_path: Path):
    wanted = model_of(measured(tmp_path, FOUR, f"{ROW}\n149,20,7,-0.06"))
    texts = {}
    for semicolon in (", ", ";"):
        omega, rates = wanted.omega, wanted.decay_rate
        poles = -rates / 2 + 1j * (omega**2 - rates**2 / 4) ** 0.5
        force = wanted.phi**2 / (2j * poles.imag) * poles
        base = -wanted.participation * wanted.phi / (2j * poles.imag) * poles
        numbers = zip(omega / (2 * math.pi), rates / (2 * omega), force, base, strict=True)
        lines = [[f, z, r.real, r.imag, b.real, b.imag] for f, z, r, b in numbers]
        rows = "\r\n".join(semicolon.join(str(float(x)) for x in line) for line in lines)
        texts[semicolon] = rows if semicolon != ";" else rows.replace(".", ",")
    names = ["frequencies_hz", "damping_ratios", "force_residues_re", "force_residues_im"]
    names += ["base_residues_re", "base_residues_im"]
    for mark, rows in texts.items():
        scene = measured(
            tmp_path, "\ufeff" + mark.join(names), rows + "\r\n;;;\r\n", "modal_data.response=velocity"
        )
        found = model_of(scene)
        for name in ("omega", "decay_rate", "phi", "participation"):
            assert getattr(found, name) == pytest.approx(getattr(wanted, name), rel=1e-9)
        assert scene_from_text(scene.dump()) == scene and set(found.points) == {"tip", "readout"}
    assert "modal_data.force_residues has a phase" in refusal(scene=str(tmp_path / "own.toml"))
    assert "has decay_rates_per_s and" in refusal("modal_data.damping_ratios=[0.1]", scene="measured_modes")


@pytest.mark.parametrize("text", WRONG_FILES)
def test_a_file_of_modes_that_is_wrong_is_refused_with_the_place(text: str, tmp_path: Path):
    (tmp_path / "own.toml").write_text('[spring]\nkind = "modal_data"\n[modal_data]\nfile = "modes.csv"\n')
    (tmp_path / "modes.csv").write_bytes(text.encode("latin-1"))
    sentence = refusal(scene=str(tmp_path / "own.toml"))
    assert sentence.startswith("modal_data.file ") and WRONG_FILES[text] in sentence


def test_measured_modes_from_a_file_beside_the_scene(tmp_path: Path):
    heading = "participation, tip_values, frequencies_hz, decay_rates_per_s"
    (tmp_path / "modes.csv").write_text(f"{heading}\n# mode 1\n0.11,8.2,24.5,3.56\n\n0.06,-7,149,20\n")
    own = tmp_path / "own.toml"
    own.write_text('[spring]\nkind = "modal_data"\n[modal_data]\nfile = "modes.csv"\n')
    scene = read_scene(own)
    assert scene.modal_data.frequencies_hz == (24.5, 149.0) and scene.modal_data.tip_values == (8.2, -7.0)
    assert scene.modal_data.file == ""  # the scene has become independent of the file
    assert "twice" in refusal("modal_data.tip_values=[1.0]", scene=str(own))
    assert "150 Hz" in refusal("drive.frequencies_hz=[150]", scene=str(own))
    assert "30 Hz" in refusal("drive.frequencies_hz=[30]", "modes.count=1", scene=str(own))
