"""Six sources with printed numbers, each beside the same number found here.

**One mode and a wall**, in the source's own units (mass 1):

    x'' + c x' + w0^2 x = A sin(w t),    A = Z w^2 with base amplitude Z,    w0 = 1

I. Ghosh, D. J. W. Simpson, arXiv:2510.16218 and its code; H. Dankowicz, F. Schilder, Recipes for Continuation
(2013), example 15.2 (COCO); SDND122 of code_aster; the Aberdeen rig (doi 10.1016/j.cnsns.2019.105095).

**Two bars.**  SDNL111 of code_aster: two uniform bars of 1 m, tip to tip, the far end of the second held.
u'' = c^2 u_xx, mass m, T = L/c, impedance J = m/T.  A force F(t) on one end moves that end with
(F(t) + 2 sum_n s^n F(t - 2 n T))/J, s = 1 if the far end is free and -1 if it is held: the exact motion
follows.  Modes, omega T and phi sqrt(m) at the end: k pi and sqrt(2), 1 for k = 0 (free), (k + 1/2) pi
(held).

**Two beams.**  Two cantilevers that meet through a soft one-sided spring, measured on a shaker: L. Woiwode
and M. Krack, J. Struct. Dyn. (2024), doi 10.25518/2684-6500.180.  A mini-beam on the right strip meets a cap
nut on the left one across a gap.  Geometry, added masses and stiffness factors are from their beam model
(maltekrack/NLtest, TESTRIGS/02_VIbeams/setUpLinearModalBeamModel.m).  The mini-beam, free at both ends, is
tied to the right beam by w and theta at its root, R (x_right, x_mini) = 0; with N a basis of the null space
of R, K = N^T K N and M = N^T M N.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.optimize import brentq
from scipy.sparse import block_diag, csr_array
from scipy.special import lambertw

import beam
import contact
from beam import ModalModel
from contact import ImpactOscillator, LinearContact, NewtonRestitution, State, Stop, orbits, simulate
from studies.shell.digits import minus, written


@dataclass(frozen=True)
class Printed:
    """One number of a source, and what is found here."""

    source: Annotated[str, "source"]
    quantity: Annotated[str, "quantity"]
    unit: Annotated[str, "unit; none for a pure number, and in the source's own units"]
    published: Annotated[float, "published"]
    ours: Annotated[float, "found here"]
    difference: Annotated[float, "found here less published"]
    source_error: Annotated[float, "error of the source"]
    verdict: Annotated[str, "verdict; agrees within the error of the source, differs beyond it"]
    note: Annotated[str, "note"] = ""


def compared(
    source: str, quantity: str, published: float, ours: float, error: float, note: str = "", unit: str = ""
) -> Printed:
    """A number in its `unit`, and whether it agrees within the source's error."""
    difference = ours - published
    verdict = "agrees" if abs(difference) <= error else "differs"
    return Printed(source, quantity, unit, published, ours, difference, error, verdict, note)


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
    return orbits.Shooting(oscillator=driven(w, 0.04, stop), m=2)


def bifurcation(w: float) -> orbits.PeriodicOrbit:
    """Below resonance the fold, above it the doubling next to the published speeds; by following p2."""
    s, b = orbits.MaximalFamily(oscillator=p2(w).oscillator, m=2).coefficients
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
    ours = driven(1.0, 0.1, stop).grazing_amplitude()
    return [compared("COCO 15.2", "amplitude at grazing", 0.1, ours, 1e-15)]


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


Array = NDArray[np.float64]
PRINTED = {0.2: -0.1, 0.4: -0.2, 0.6: -0.1, 0.8: 0.0, 1.0: 0.2}
"""Time [ms] -> displacement [mm] of the contact end of the first bar, which arrives at 1 m/s."""

MODES, STIFFNESS, ROOT_MASS, WAVE = 400, 5e9, math.sqrt(3.12), math.sqrt(2e11 / 7800.0)
"""Modes of each bar; stiffness of the contact [N/m]; root of the mass [kg^0.5]; speed of waves [m/s]."""


def series(count: int, held: bool) -> tuple[Array, Array]:
    """The first exact modes: omega T and phi sqrt(m)."""
    k = np.array([i + 0.5 * held for i in range(count)])
    return math.pi * k, np.where(k == 0.0, 1.0, math.sqrt(2.0))


def met(times: Array, transit: float, lag: float) -> Array:
    """Place of the first bar's contact end at 1 m/s [m] up to 6 T; with lag = J/(2 k) [s] the force is
    J (1 - exp(-t/lag))/2 to 4 T, then J ((1 + s) exp(-s) - 1/2), s = (t - 4 T)/lag, down to zero."""
    end, place = -lambertw(-0.5 / math.e, -1).real - 1.0, -times
    for back, count in ((0.0, 1.0), (2.0 * transit, 2.0), (4.0 * transit, 2.0)):  # impulse of F/J
        rise = np.clip(times - back, 0.0, 4.0 * transit)
        s = np.clip((times - back - 4.0 * transit) / lag, 0.0, end)
        fall = 4.0 - s - 2.0 * (2.0 + s) * np.exp(-s)
        place = place + 0.5 * count * (rise + lag * np.expm1(-rise / lag) + lag * fall)
    return place


def two_bars() -> list[Printed]:
    """The contact end of the first bar at the printed times, beside the exact wave."""
    (free, tip), (held, other) = series(MODES, False), series(MODES, True)
    omega = WAVE * np.append(free, held)
    phi = np.append(-tip, other) / ROOT_MASS  # positive when they approach
    model = ModalModel(omega=omega, decay_rate=0.0 * omega, phi=phi, participation=0.0 * omega)
    bars = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=LinearContact(stiffness=STIFFNESS)))
    start = State(displacement=0.0 * omega, velocity=-ROOT_MASS * (np.arange(omega.size) == 0))
    times = 1e-3 * np.array(list(PRINTED))
    run = simulate(bars, start, duration=1e-3, times=times)
    found = run.displacement[:, :MODES] @ tip / ROOT_MASS
    exact = met(times, 1.0 / WAVE, 0.5 * ROOT_MASS**2 * WAVE / STIFFNESS)
    return [
        compared(
            "SDNL111",
            f"contact end at {time} ms",
            1e-3 * printed,
            float(ours),
            0.05e-3 * abs(printed or 0.2),  # at zero 5 % of the largest
            f"exact wave {written(wave)} m",
            "m",
        )
        for (time, printed), ours, wave in zip(PRINTED.items(), found, exact, strict=True)
    ]


LEFT, RIGHT = (30.95, 199.04, 556.82, 1085.93), (28.20, 205.54, 277.74, 594.98, 1168.62)  # measured, Hz
MODEL_ERROR = 0.03  # of frequencies: their beam model, tuned by hand, meets them to 1-3 %
LENGTH, WIDTH, HEIGHT, E, DENSITY = 0.3925, 0.060, 0.006, 210e9, 7720.0
CONTACT, ROOT, PLATE = LENGTH - 0.0115, LENGTH - 0.0625, 0.040


def _strip(
    pieces: Sequence[tuple[float, float, float]],
    nut: float,
    width: float = WIDTH,
    height: float = HEIGHT,
    held: beam.Support = "clamped",
    tip_at: float = CONTACT,
    tie: float = ROOT,
) -> beam.Discretization:
    """A strip, free at its far end, of pieces (length, stiffness over that of steel, added mass)."""
    steel = [
        beam.Material(
            youngs_modulus=factor * E, poissons_ratio=0.3, density=DENSITY + added / (length * width * height)
        )
        for length, factor, added in pieces
    ]
    return beam.assemble(
        beam.LeafSpring(
            centreline=beam.Centreline(pieces=tuple(beam.Straight(length=piece[0]) for piece in pieces)),
            sections=tuple(beam.StripSection(material=m, width=width, thickness=height) for m in steel),
            supports=(held, "free"),
            tip=beam.Tip(mass=nut),
            tip_at=tip_at,
            readouts={"w": beam.Readout(at=tie), "turn": beam.Readout(at=tie, quantity="rotation")},
        )
    )


def both_beams(plate_end: float = ROOT, count: int = 6) -> tuple[beam.Modes, beam.Modes]:
    """Modes of the left beam and of the right one with its mini-beam; the 40 mm of the tuning plate, or of
    the mini-beam's clamp, end at `plate_end` [m] from the support."""

    def bolted(bare: float, factor: float, plate: float, added: float) -> list[tuple[float, float, float]]:
        stiffness = bare * factor * (1.0 + plate * PLATE / WIDTH / HEIGHT) ** 3
        return [(plate_end - PLATE, bare, 0.0), (PLATE, stiffness, added), (LENGTH - plate_end, bare, 0.0)]

    left = _strip(bolted(1.0, 0.75, 1e-3, 0.0427), 0.0133)
    right = _strip(bolted(1.08, 0.1, 13.5e-3, 0.0307 * 40 / 97 + 0.0606 + 0.0543 + 0.0819), 0.0)
    excess = 0.0307 * 57 / 97 - DENSITY * 0.057 * 0.040 * 1e-3
    mini = _strip([(0.057, 1.07, excess)], 0.0, 0.040, 1e-3, "free", CONTACT - ROOT, 0.0)
    basis = null_space([np.append(right.readouts[x], -mini.readouts[x]) for x in ("w", "turn")])
    both = {
        name: csr_array(basis.T @ (block_diag([getattr(x, name) for x in (right, mini)]) @ basis))
        for name in ("stiffness", "mass", "loss_stiffness")
    }
    tied = replace(
        right,
        **both,
        base_load=np.append(right.base_load, mini.base_load) @ basis,
        tip=np.append(0.0 * right.tip, mini.tip) @ basis,
        ties=right.ties @ csr_array(basis[: -mini.n_dofs]),
        readouts={"beam": np.append(right.tip, 0.0 * mini.tip) @ basis},
    )
    return beam.natural_modes(left, count), beam.natural_modes(tied, count)


def two_beams() -> list[Printed]:
    """Frequencies of both beams beside the measured ones.

    Mode 5 of the right beam differs: exact transfer matrices of the published drawing give our number.
    """
    return [
        compared(
            "Woiwode and Krack 2024",
            f"{side} beam, mode {k}",
            f,
            float(a),
            MODEL_ERROR * f,
            f"{b:.5g} Hz with the plates 10 mm further out",
            "Hz",
        )
        for side, measured, here, out in zip(
            ("left", "right"), (LEFT, RIGHT), both_beams(), both_beams(ROOT + 0.01), strict=True
        )
        for k, f, a, b in zip(range(1, 6), measured, here.frequencies_hz, out.frequencies_hz, strict=False)
    ]
