"""Old names go on working and warn."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

import contact

MODULES = {
    "contact.nordmark": ("contact.maps.nordmark", "NordmarkMap"),
    "contact.stroboscope": ("contact.maps.stroboscope", "StroboscopicMap"),
    "contact.nonlinear_mode": ("contact.maps.nonlinear_mode", "NonlinearMode"),
    "contact.orbits.shooting": ("contact.orbits.families.shooting", "Shooting"),
    "contact.orbits.single_impact": ("contact.orbits.families.single_impact", "MaximalFamily"),
    "contact.orbits.kick": ("contact.orbits.families.kick", "KickFamily"),
    "contact.orbits.continuation": ("contact.orbits.branches.continuation", "follow"),
}


@pytest.mark.parametrize("old", MODULES)
def test_a_module_of_before_has_the_names_of_its_new_place(old: str) -> None:
    new, name = MODULES[old]
    module = importlib.import_module(old)
    with pytest.warns(DeprecationWarning, match=f"{old} is now {new}"):
        found = getattr(module, name)
    assert found is getattr(importlib.import_module(new), name)
    with pytest.raises(AttributeError):
        _ = module.no_such_name


def test_the_strobed_map_of_before_is_the_map_at_its_control_parameter() -> None:
    nordmark = contact.NordmarkMap(alpha=0.5, gamma=0.8, restitution=0.1)
    with pytest.warns(DeprecationWarning, match=r"replace\(nordmark, control=rho\)"):
        strobed = contact.StrobedNordmarkMap(map=nordmark, rho=0.01)
    assert strobed == replace(nordmark, control=0.01) != nordmark
    assert nordmark.at(nordmark.excess(0.01)).control == pytest.approx(0.01, rel=1e-14)
    run = strobed.orbit([0.2, -0.1], 5)
    assert np.array_equal(run.points, nordmark.iterate([0.2, -0.1], 0.01, 5))
    assert isinstance(strobed, contact.StrobedMap)
