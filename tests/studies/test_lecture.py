"""What a lecturer sets on the bench: its numbers by another route, its slides, and what it does not say."""

import math
import re

import pytest
from PIL import Image

from contact import simulate
from contact.maps.stroboscope import StroboscopicMap
from contact.orbits import onset_orbit
from studies.experiment.lecture import in_words
from studies.shell.scene import beam_at, model_of, read_scene

KEPT, HZ = "modes.count=8", 7.87


def test_the_settings_are_right_by_another_route_and_the_slides_are_wide(run_study):
    rig = "--scene", "steel_ruler", "--set", KEPT, "--frequency", str(HZ)
    ran = run_study("lecture", "--quick", *rig, "--frames", "3")
    mm, text = ran.summary["amplitudes_mm"], (ran.folder / "lecture.txt").read_text()
    assert ran.code == 0 and ran.summary["sentences"] == text.splitlines()
    scene = read_scene("steel_ruler", [KEPT])
    model, drive = model_of(scene), 2.0 * math.pi * HZ
    # q'' + c q' + omega^2 q = -participation base''
    transfer = drive**2 * model.participation / (model.omega**2 - drive**2 + 1j * drive * model.decay_rate)
    grazing = 1e3 * scene.stop.gap_m / abs(model.phi @ transfer)
    assert mm["grazing"] == pytest.approx(grazing, rel=1e-9)
    assert 0.0 < mm["begins"] - grazing <= 0.01 and 0.0 < mm["last"] - mm["ends"] <= 0.01
    size = 1e-3 * mm["begins"] * drive**2 / 9.80665
    said = [
        f"{mm['begins']:.2f} mm: the ball begins to hit",
        f"{2 * mm['begins']:.2f} mm from peak",
        f"{size:.3g} g.",
    ]
    said += [
        f"to {mm['ends']:.2f} mm: the impacts end",
        f"and end below {mm['last']:.4f} mm",
        "too small for steps",
    ]
    said += ["180 mm free", "8.00 mm", "p5", f"vibrates at {model.frequencies_hz[0]:.2f} Hz"]
    assert [words for words in said if words not in text] == []
    # from the orbit at the setting: it keeps its impacts just above the end, and loses them at the setting
    strobed = StroboscopicMap(oscillator=beam_at(scene, HZ, model))
    orbit = onset_orbit(strobed, mm["begins"] / grazing - 1.0).end
    for amplitude, kept in ((mm["last"] + 0.3 * (grazing - mm["last"]), True), (mm["ends"], False)):
        run = simulate(strobed.oscillator.with_amplitude(1e-3 * amplitude), orbit, periods=1500)
        assert bool(run.strobe_impacts[-100:].any()) == kept
    (first, born), down = [
        [r for r in ran.summary["rows"] if r["direction"] == way] for way in ("up", "down")
    ]
    assert (first["impacts"], down[-1]["impacts"]) == (0, 0)
    assert (
        down[0]["seen"] == born["seen"] == "one impact in 5 shakes" and down[-1]["to_mm"] == first["from_mm"]
    )
    for slide in ("slide_1", "slide_2"):
        with Image.open(ran.folder / f"{slide}.png") as found:
            assert found.width / found.height == pytest.approx(16 / 9, rel=0.01)
    for words in (text, ran.err, (ran.folder / "columns.json").read_text(), str(ran.summary["findings"])):
        assert not re.search(r"letter|excess|brass", words, re.IGNORECASE)


def test_two_stops_are_refused(run_study, tmp_path):
    scene = tmp_path / "two.toml"
    scene.write_text("[[stops]]\ngap_m = 0.012")
    ran = run_study("lecture", "--scene", str(scene))
    assert ran.code == 2 and "[[stops]]" in ran.err.splitlines()[-1]


def test_each_motion_has_its_words():
    found = [in_words(*motion) for motion in ((1, 0), (1, 1), (4, 1), (4, 2), (0, 9))]
    assert len(set(found)) == 5 and found[2] == "one impact in 4 shakes" and "irregular" in found[-1]
