"""The pictures of the README show what is computed: each carries its numbers."""

import json

import numpy as np
import pytest
from PIL import Image

from contact.orbits import Shooting, fold_of
from studies import pictures
from studies.letter import TIME_TRACE_HZ
from studies.shell.scene import beam_at, model_of


def shown_in(folder, name):
    """What the picture says that it shows; it is small and has its shape."""
    with Image.open(path := folder / f"{name}.png") as image:
        assert image.format == "PNG" and path.stat().st_size <= 60_000
        assert image.size == {"p4": (1680, 630), "costs": (1050, 630)}[name]
        return json.loads(image.text["drawn"])


def test_the_orbit_keeps_its_four_branches_down_to_the_fold():
    shown = shown_in(pictures.PICTURES, "p4")
    beam = beam_at(pictures.SCENE, TIME_TRACE_HZ, model_of(pictures.SCENE))
    fold, grazing = fold_of(Shooting(oscillator=beam, m=4)), 1e3 * beam.grazing_amplitude()
    assert shown["grazing"] == pytest.approx(grazing, rel=1e-5)
    assert shown["fold"] == pytest.approx(grazing * (1.0 + fold.excess), rel=1e-5)
    for way, end in {"raised": grazing, "lowered": shown["fold"]}.items():
        amplitudes, strobes = np.array(shown["amplitudes"][way]), np.array(shown["strobes"][way])
        branches = [len(np.unique(np.round(row, 3))) for row in strobes]
        assert branches == np.where(amplitudes > end, 4, 1).tolist()
    assert beam.tip(np.array(shown["impact"])) == pytest.approx(beam.stop.gap, rel=1e-5)
    assert beam.tip(np.array(shown["lowest"])) < 1e-3 * np.min(shown["strobes"]["raised"])


def test_the_costs_are_those_of_the_table():
    shown = shown_in(pictures.PICTURES, "costs")
    assert shown == pictures.costs_drawn()
    assert all(row["microseconds_at_1e-4"] <= row["microseconds_at_1e-8"] for row in shown.values())
    assert [name for name, row in shown.items() if row["error"]][:1] == ["exact"]


@pytest.mark.slow
def test_the_command_draws_what_is_committed(tmp_path):
    assert pictures.main(["--out", str(tmp_path)]) == 0
    assert shown_in(tmp_path, "costs") == shown_in(pictures.PICTURES, "costs")
    drawn, kept = shown_in(tmp_path, "p4"), shown_in(pictures.PICTURES, "p4")
    assert drawn.keys() == kept.keys()
    for one, other in zip(drawn.values(), kept.values(), strict=True):
        pairs = ((one[way], other[way]) for way in one) if isinstance(one, dict) else [(one, other)]
        for new, old in pairs:
            np.testing.assert_allclose(new, old, rtol=1e-4, atol=1e-9)
