"""What was fitted, as a scene that every study takes: the modes as measured ones, the law by its keys."""

from __future__ import annotations

import math
from collections.abc import Iterable

from contact import HertzContact, LinearContact
from studies.identify.fit import Fit
from studies.identify.parameters import parameters_of
from studies.scene import Scene, hertz_of

__all__ = ["fitted_scene"]

MODULI = ("tip.ball_young_modulus_pa", "tip.plate_young_modulus_pa")


def fitted_scene(scene: Scene, found: Fit, notes: Iterable[object]) -> str:
    """The scene with what was fitted, as TOML; what no key of a scene holds is told in its first lines."""
    oscillator, model, law = found.oscillator, found.oscillator.model, found.oscillator.stop.law
    known = {name: one.value for name, one in parameters_of(oscillator).items()}
    frequencies = sorted(set(found.record.rows[:, 0])) if found.record.kind == "transitions" else []
    changes: dict[str, object] = {
        "spring.kind": "modal_data",
        "modal_data.frequencies_hz": (model.omega / (2.0 * math.pi)).tolist(),
        "modal_data.decay_rates_per_s": model.decay_rate.tolist(),
        "modal_data.tip_values": model.phi.tolist(),
        "modal_data.participation": model.participation.tolist(),
        "modal_data.tip_mass_kg": model.tip_mass or 0.0,
        "modal_data.static_compliance_m_per_n": model.static_compliance or 0.0,
        "single_mode.free_period_s": known["free_period"],
        "single_mode.decay_rate_per_s": known["decay_rate"],
        "stop.gap_m": known["gap"],
        "drive.frequencies_hz": frequencies or [known["frequency"]],
    }
    if isinstance(law, LinearContact):
        changes |= {"contact.law": "linear", "contact.stiffness_n_per_m": law.stiffness,
                    "contact.damping_ns_per_m": law.damping}  # fmt: skip
    elif isinstance(law, HertzContact):
        harder = law.stiffness / hertz_of(scene).stiffness
        changes |= {key: harder * scene.number(key) for key in MODULI}
    else:
        changes |= {"contact.law": "newton", "contact.local_restitution": known["restitution"]}
    if model.n_modes == 1:
        changes["single_mode.restitution"] = known["restitution"]
    errors = dict(zip(found.names, found.errors, strict=True))
    lines = [
        f"# {name}: {known[name]:.8g} +- {errors[name]:.2g} {one.unit}"
        for name, one in parameters_of(oscillator).items() if name in errors
    ]  # fmt: skip
    if "delay" in known:
        lines.append(f"# a scene has no key for the delay, {known['delay']:.6g} s (DelayedRestitution)")
    return "\n".join([*lines, "", scene.replace(changes, provenance="fitted").dump()])
