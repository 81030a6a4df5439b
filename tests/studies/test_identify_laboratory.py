"""Records of laboratories, by simulators that know nothing of the fit: starts are found, truth comes out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oscillators import modes_on_stop, newton
from record_simulators import Beam, draw

from contact import ImpactOscillator, LinearContact
from studies.measurement.identify.fit import fit
from studies.measurement.identify.records import Record


def oscillator_of(lab: Beam) -> tuple[ImpactOscillator, dict[str, float]]:
    """An oscillator to start from, and the true values of what is fitted."""
    rows, law = (lab.omega, lab.c, lab.phi, lab.gamma), newton(0.2)
    truth = {name: getattr(lab, name) for name in ("gap", "amplitude", "frequency")}
    truth |= {"free_period": 2 * math.pi / math.sqrt(lab.omega[0] ** 2 - 0.25 * lab.c[0] ** 2)}
    truth |= {"decay_rate": lab.c[0]}
    if lab.stiffness is None:
        rows, truth["restitution"] = (154.0, 3.56, 1.0, 1.0), lab.restitution
    else:
        law, truth["stiffness"] = LinearContact(stiffness=2.0 * lab.stiffness), lab.stiffness
    return modes_on_stop(*rows, law=law, drive=(lab.frequency, 1e-3)), truth


@pytest.mark.parametrize(
    ("kind", "seed", "known"),
    [("equation_1", 9, True), ("equation_1", 11, True), ("equation_1", 2, False), ("two_modes", 1, True)],
)
def test_phase_offset_sign_and_lost_rows_are_no_obstacle(kind: str, seed: int, known: bool) -> None:
    """The reading is turned, shifted by 3 mm and begins at 7 s; one row in ten is lost."""
    record = draw(kind, seed)
    start, truth = oscillator_of(record.beam)
    kept = np.sort(np.random.default_rng(seed).permutation(record.time.size)[: 9 * record.time.size // 10])
    rows = np.column_stack([record.time + 7.0, 3e-3 - record.value])[kept]
    given = truth["frequency"] * 1.001 if known else None
    found = fit(Record(columns=("time_s", "x_m"), rows=rows, frequency=given), start, tuple(truth))
    off = found.estimate[: len(truth)] - np.array(list(truth.values()))
    assert np.all(np.abs(off) < 3.5 * found.errors[: len(truth)]) and not found.too_small
    assert found.noise == pytest.approx(record.noise_sd, rel=0.15)
    sensor = dict(zip(found.names, found.estimate, strict=True))
    # a cosine, from 7 s on
    turn = 0.5 * math.pi - 2.0 * math.pi * sensor["frequency"] * 7.0 - sensor["phase"]
    assert abs(math.remainder(turn, 2.0 * math.pi)) < 0.05
    assert sensor["offset"] == pytest.approx(3e-3, abs=4.0 * found.errors[found.names.index("offset")])
    low, high = found.intervals().T
    assert np.all((low <= found.estimate) & (found.estimate <= high)) and np.all(low[: len(truth)] > 0.0)
