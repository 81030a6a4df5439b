"""What a film says of itself, in its frames and at the end."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from studies.instruments.motion.filmed_orbit import FilmedOrbit
from studies.instruments.motion.orbit_film import OrbitFilm

__all__ = ["closing_lines", "slow_motion", "words_of"]


def slow_motion(orbit: FilmedOrbit) -> list[dict[str, float]]:
    """Every slow-motion factor, the frames that have it and the time that they stand for."""
    law = orbit.law
    return [
        {
            "slowed": float(factor),
            "frames": int(np.sum(law.slowed == factor)),
            "time_s": float(law.step[law.slowed == factor].sum()),
        }
        for factor in np.unique(law.slowed)
    ]


def words_of(film: OrbitFilm, frequency: float, excess: float) -> tuple[str, str]:
    """The two lines over every frame and over the contact sheet."""
    orbit = film.orbit
    name = f"p$_{{{orbit.period}}}$" if orbit.period else "no period"
    title = f"{name} at {frequency:.2f} Hz, F/F$_g$ $-$ 1 = {excess:g}"
    enlarged = film.shape.magnification
    shape = "all to scale"
    if enlarged != 1.0:
        shape = f"higher modes drawn {enlarged:g} times, tip and gap to scale"
    if not film.shaken:
        return title, f"{shape}; seen from the base"
    shaken = 1e3 * float(orbit.oscillator.drive.amplitude)  # type: ignore[union-attr]
    return title, f"{shape}; the exciter moves by {shaken:.2f} mm"


def closing_lines(film: OrbitFilm, frequency: float, excess: float, folder: Path) -> list[str]:
    """What was filmed, for a person."""
    orbit = film.orbit
    name = f"p{orbit.period}" if orbit.period else "no period up to 64"
    slowed = orbit.law.slowed
    factors = " to ".join(f"{factor:g}" for factor in sorted({slowed.min(), slowed.max()}))
    enlarged = film.shape.magnification
    count = len(orbit.contacts)
    lines = [
        f"{frequency:g} Hz, excess {excess:g}: {name}, {count} impact{'' if count == 1 else 's'} in "
        f"{1e3 * orbit.duration:.1f} ms; {film.count} frames, slowed {factors} times, "
        + (f"higher modes drawn {enlarged:g} times" if enlarged != 1.0 else "all modes drawn to scale")
    ]
    if not orbit.contacts:
        lines.append("no impacts: the drive does not reach the plate, or the orbit without impacts is stable")
    lines.append(f"ParaView: open {folder / 'motion.pvd'} and press play; colour by contact")
    return lines
