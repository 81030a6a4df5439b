"""Born period and fold of p_m at one frequency, in the map, Eq. (1) and the beam, after a change.

A hysteresis is compared with that of the same p_m before the change, whatever is born after it:

    born period      at F/F_g - 1 = 1e-3, started just below grazing
    fold             F_m/F_g - 1 at the end of the p_m orbit that is born without the change: closed forms for
                     map and Eq. (1), shooting for the beam
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from beam import ModalModel
from contact.errors import ContactError
from contact.maximal_orbits import fold as fold_of_map
from contact.nordmark import StrobedNordmarkMap
from contact.orbits.continuation import fold_of
from contact.orbits.kick import KickFamily
from contact.orbits.shooting import Shooting
from contact.orbits.single_impact import MaximalFamily
from contact.stroboscope import StroboscopicMap
from studies.instruments.oscillators import beam_of, nordmark_of, single_mode_oscillator
from studies.instruments.scene import Scene
from studies.instruments.sensitivity.grazing_births import period_of_birth
from studies.instruments.sensitivity.scene_changes import Change

__all__ = ["beam_fold", "row_at"]


def beam_fold(scene: Scene, model: ModalModel, frequency: float, period: int) -> float | None:
    """F_m/F_g - 1 where the beam's p_m ends, from shooting started on kicks; None where there is no fold."""
    oscillator = beam_of(scene, frequency, model)
    try:
        kick = KickFamily(oscillator=oscillator, period=period).fold()
        if kick is None:
            return None
        found = fold_of(Shooting(oscillator=oscillator, period=period, impacts=kick.kick.touches))
    except ContactError:
        return None
    return None if found is None else found.excess


def row_at(
    scene: Scene, model: ModalModel, frequency: float, change: Change | None, base: Mapping[str, int] | None
) -> tuple[dict[str, Any], Mapping[str, int]]:
    """One row of the table, and the born periods whose folds it gives: those of `base`, or its own."""
    strobed: dict[str, Any] = {
        "map": StrobedNordmarkMap(map=nordmark_of(scene, frequency)),
        "single_mode": StroboscopicMap(oscillator=single_mode_oscillator(scene, frequency)),
        "beam": StroboscopicMap(oscillator=beam_of(scene, frequency, model)),
    }
    row: dict[str, Any] = {
        "frequency_hz": frequency,
        "parameter": "none" if change is None else change.parameter,
        "change": "" if change is None else change.text,
        "sign": 0 if change is None else change.sign,
    }
    for name, one in strobed.items():
        row[f"born_{name}"] = period_of_birth(one)
    periods = base or {name: row[f"born_{name}"] or 0 for name in strobed}
    row |= {"m": periods["beam"], "fold_map": None, "fold_single_mode": None, "fold_beam": None}
    if periods["map"] > 1:
        on_map = fold_of_map(strobed["map"].map, periods["map"])
        row["fold_map"] = None if on_map is None else strobed["map"].map.excess(on_map.rho)
    if periods["single_mode"] > 1:
        single = MaximalFamily.from_oscillator(
            strobed["single_mode"].oscillator, period=periods["single_mode"]
        ).fold()
        row["fold_single_mode"] = None if single is None else single.excess
    if periods["beam"] > 1:
        row["fold_beam"] = beam_fold(scene, model, frequency, periods["beam"])
    return row, periods
