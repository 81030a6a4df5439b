"""One mode and a wall: four sources with their own numbers and units (mass 1).

    x'' + c x' + w0^2 x = A sin(w t),    A = Z w^2 with base amplitude Z,    w0 = 1

I. Ghosh, D. J. W. Simpson, arXiv:2510.16218 and its code; H. Dankowicz, F. Schilder, Recipes for Continuation
(2013), example 15.2 (COCO); SDND122 of code_aster; the Aberdeen rig (doi 10.1016/j.cnsns.2019.105095).
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

import contact
from beam import ModalModel
from contact import ImpactOscillator, LinearContact, NewtonRestitution, Stop, orbits
from studies.methods.validation.printed import Printed, compared
from studies.shell.digits import minus

PUBLISHED = {
    0.788138: (0.3506941722911653, 0.9999974, 0.4280592),
    0.794578: (0.3634213705816635, 1.0000019, 0.4302758),
    0.799: (0.3628362019762544, 1.0000013, 0.4317851),
    0.80079: (0.3601817820562527, -1.0000095, -0.4323892),
    0.81: (0.3475333988945534, -0.9999967, -0.4354918),
    0.90041: (0.3547298341037635, -0.9999948, -0.4634917),
}
SPEEDS = {0.80079: 0.0060385158, 0.81: 0.0653039883, 0.90041: 0.7509614590}
"""Ghosh and Simpson: F and multipliers, good to 1e-5, which is 1e-10 in F at a fold; speeds at doublings."""


def driven(w: float, decay: float, stop: Stop, base: float = 1.0) -> ImpactOscillator:
    """The oscillator with w0 = 1, c = `decay` and Z = `base`."""
    one = np.ones(1)
    model = ModalModel(omega=one, decay_rate=decay * one, phi=one, participation=one)
    drive = contact.HarmonicDrive(frequency=w / (2 * math.pi), amplitude=base)
    return ImpactOscillator(model=model, stop=stop, drive=drive)


rig = partial(driven, decay=0.02, stop=Stop(gap=1.0, law=LinearContact(stiffness=29.0)))
"""The Aberdeen rig, displacements over its gap."""


def p2(w: float) -> orbits.Shooting:
    """Ghosh and Simpson's orbits with one impact in two drive periods."""
    stop = Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.9))
    return orbits.Shooting(oscillator=driven(w, 0.04, stop), period=2)


def bifurcation(w: float) -> orbits.PeriodicOrbit:
    """Below resonance the fold, above it the doubling next to the published speeds; by following p2."""
    s, b = orbits.MaximalFamily(oscillator=p2(w).oscillator, period=2).coefficients
    near = s / (s * s + b * b) if s > 0 else float(np.interp(w, list(SPEEDS), list(SPEEDS.values())))
    branch = orbits.follow(p2(w), p2(w).at_speed(1.1 * near), low=0.5 * near, high=2.0 * near)
    return min(branch.of_kind("fold" if s > 0 else "period doubling"), key=lambda one: abs(one.speed - near))


def ghosh_simpson() -> list[Printed]:
    """Folds and doublings of p2: amplitude, multipliers and impact speeds."""
    row, rows = partial(compared, "Ghosh and Simpson"), list[Printed]()
    for w, (published, *multipliers) in PUBLISHED.items():
        orbit = theirs = bifurcation(w)
        error, digit, there, at = 1e-10, 1e-5, f"fold at ω = {w}", ""
        if w in SPEEDS:
            beside = p2(w).at_speed(1.001 * orbit.speed, orbit)
            share = 1e-5 * w * w / abs(beside.multipliers[0].real + 1)
            error = share * abs(beside.amplitude - orbit.amplitude)
            theirs = p2(w).at_excess(published / math.hypot(1 - w * w, 0.04 * w) - 1, orbit)
            digit, there, at = 1e-7, f"doubling at ω = {w}", ", their F"
            rows.append(row(f"impact speed, {there}{at}", SPEEDS[w], theirs.speed, 1e-10))
        note = f"theirs has the multiplier {minus(str(multipliers[0]))}"
        rows.append(row(f"amplitude, {there}", published, orbit.amplitude * w * w, error, note))
        rows += [
            row(f"multiplier {number}, {there}{at}", one, float(ours.real), digit)
            for number, one, ours in zip((1, 2), multipliers, theirs.multipliers, strict=True)
        ]
    return rows


def coco() -> list[Printed]:
    """Grazing at w = 1."""
    stop = Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.8))
    return [
        compared("COCO 15.2", "amplitude at grazing", 0.1, driven(1.0, 0.1, stop).grazing_amplitude(), 1e-15)
    ]


def sdnd122() -> list[Printed]:
    """Frequency of the free oscillation against a spring, in units of k and gap."""
    free = replace(driven(0.5, 0.0, Stop(gap=1.0, law=LinearContact(stiffness=5.0))), drive=None)
    e = 0.00650108 / 1e-3  # energy over k gap^2
    start = contact.State(displacement=np.array([-math.sqrt(2 * e)]), velocity=np.zeros(1))
    f = math.sqrt(10) / np.diff(contact.simulate(free, start, duration=15.0).impacts.start)[0]
    angle = math.acos(-1 / math.sqrt(2 * e)) + math.acos(math.sqrt(10 / (120 * e - 50))) / math.sqrt(6)
    note = f"the source has a regularised wall; closed form {math.sqrt(10) / (2 * angle):.9f} Hz"
    return [compared("SDND122", "frequency at 0.00650108 J", 0.646694, float(f), 5e-7, note, "Hz")]


def aberdeen() -> list[Printed]:
    """Grazing at a = 0.7 (experiments: Ing, Pavlovskaia et al. 2008)."""
    graze = brentq(lambda w: 1.26 * rig(w).grazing_amplitude() - 0.7, 0.7, 0.9, xtol=1e-15)
    return [compared("Aberdeen rig", "ω at grazing, a = 0.7", 0.80193, float(graze), 5e-6)]
