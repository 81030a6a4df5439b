"""One mode and a wall: four sources with their own numbers and units (mass 1).

    x'' + c x' + w0^2 x = A sin(w t),    A = Z w^2 with base amplitude Z,    w0 = 1 but in SDND122

I. Ghosh, D. J. W. Simpson, arXiv:2510.16218 and its code; H. Dankowicz, F. Schilder, Recipes for Continuation
(2013), example 15.2 (COCO); SDND122 of code_aster; the Aberdeen rig (doi 10.1016/j.cnsns.2019.105095).
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import groupby

import numpy as np
from scipy.optimize import brentq

import contact
from beam import ModalModel
from contact import ImpactOscillator, LinearContact, NewtonRestitution, Stop, StroboscopicMap, orbits
from studies.methods.validation.rows import Curve, Panel, Section, compared
from studies.shell.study import Run

Cell = tuple[float, str, float, np.ndarray]

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


rig = partial(driven, decay=0.02, stop=Stop(gap=1.0, law=LinearContact(stiffness=29.0)))  # x, a over e


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


def ghosh_simpson(run: Run) -> Section:
    """Folds and doublings of p2, their slopes, and the tangency of the folds to grazing at resonance."""
    row, rows, errors = partial(compared, "Ghosh and Simpson"), [], dict.fromkeys(PUBLISHED, 1e-10)
    excess = {w: F / math.hypot(1 - w * w, 0.04 * w) - 1 for w, (F, *_) in PUBLISHED.items()}
    for w, (published, *multipliers) in PUBLISHED.items():
        orbit = theirs = bifurcation(w)
        digit, there = 1e-5, f"at the fold, w = {w}"
        if w in SPEEDS:
            beside = p2(w).at_speed(1.001 * orbit.speed, orbit)
            share = 1e-5 * w * w / abs(beside.multipliers[0].real + 1)
            errors[w] = share * abs(beside.amplitude - orbit.amplitude)
            theirs = p2(w).at_excess(excess[w], orbit)
            digit, there = 1e-7, f"at the doubling, w = {w}, and their F"
            rows.append(row(f"impact speed {there}", SPEEDS[w], theirs.speed, 1e-10))
        note = f"theirs has the multiplier {multipliers[0]}"
        rows.append(row(f"F at w = {w}", published, orbit.amplitude * w * w, errors[w], note))
        rows += [
            row(f"multiplier {there}", one, float(ours.real), digit)
            for one, ours in zip(multipliers, theirs.multipliers, strict=True)
        ]
    points, weights = np.polynomial.legendre.leggauss(6)
    for low, high in ((0.788138, 0.794578), (0.794578, 0.799), (0.80079, 0.81)):
        rates = orbits.excess_derivatives if high not in SPEEDS else orbits.doubling_derivatives
        between = [bifurcation(w) for w in low + (high - low) * (1 + points) / 2]
        slopes = [rates(orbit, [orbits.Change(frequency=0.5 / math.pi)])[0] for orbit in between]
        ours, error = float(weights @ slopes) * (high - low) / 2, (errors[low] + errors[high]) / 0.36
        rows.append(row(f"integral of d(F/F_g)/dw, {low} to {high}", excess[high] - excess[low], ours, error))
    near = 0.7998 - 1e-4 * np.arange(6)
    root = np.polynomial.Polynomial.fit(near, [math.sqrt(-bifurcation(w).excess) for w in near], 4)
    resonance = float(brentq(root, 0.7998, 0.8))
    bend, exact = -(float(root.deriv()(resonance)) ** 2), 0.8 * math.sqrt(1 - 0.02**2)
    decay = math.exp(-0.08 * math.pi / exact)
    known = -8 * (math.pi * 1.9 * decay / (exact * (1 + decay) * (1 - 0.9 * decay))) ** 2
    rows += [
        row("w_0, where folds graze", None, resonance, note=f"from folds; closed form {exact:.12f}"),
        row("(F/F_g - 1)/(w - w_0)^2 there", None, bend, note=f"closed form {known:.6f}"),
    ]
    ws = np.linspace(0.788138, 0.7998, 9 if run.quick else 60)
    curves = [
        Curve(x=ws, y=[bifurcation(w).excess for w in ws], name="folds"),
        Curve(x=[*excess][:3], y=[*excess.values()][:3], name="published", line=False),
        Curve(x=ws, y=bend * (ws - resonance) ** 2, name="tangent parabola", look=1),
    ]
    panel = Panel(title="", x=("w", "1"), y=(r"$F/F_g - 1$", "1"), curves=curves)
    return Section(rows=rows, panels=[panel], caption="Folds of p2 touch grazing at resonance.")


def highest(orbit: orbits.SingleImpactOrbit) -> float:
    """Largest x of COCO's flight between impacts, in closed form at times that are dense at both ends."""
    w, wd = orbit.oscillator.driven.angular_frequency, math.sqrt(1 - 0.05**2)
    t = math.pi * (1 - np.cos(np.linspace(0, math.pi, 2001)[1:-1])) / w
    drive = orbit.amplitude * w * w * np.exp(1j * w * orbit.phase) / (1 - w * w + 0.1j * w)
    d, v = 1 - drive.imag, -0.8 * orbit.speed - w * drive.real
    free = np.exp(-0.05 * t) * (d * np.cos(wd * t) + (v + 0.05 * d) / wd * np.sin(wd * t))
    return float(np.max((drive * np.exp(1j * w * t)).imag + free))


def coco(run: Run) -> Section:
    """Grazing, and which orbits of one impact a period pierce the wall, for A from 0.01 to 1."""
    row, rows, panels = partial(compared, "COCO 15.2"), [], []
    stop = Stop(gap=1.0, law=NewtonRestitution(local_restitution=0.8))
    for w in (1.0, 0.6):
        family = orbits.MaximalFamily(oscillator=driven(w, 0.1, stop), period=1)
        grazing = family.oscillator.grazing_amplitude() * w * w
        fast = family.orbits(1 / grazing - 1)[-1].speed * np.geomspace(1e-4, 2, 40 if run.quick else 400)
        flights = [family.orbit_of(family.kick(float(v))) for v in (*-fast[::-1], *fast)]
        flights = [orbit for orbit in flights if 0.01 <= orbit.amplitude * w * w <= 1]
        through = np.array([highest(orbit) > 1 + 1e-12 for orbit in flights])
        wrong, note = np.sum(through == [orbit.admissible for orbit in flights]), f"{through.sum()} pierce it"
        exact, known = math.hypot(1 - w * w, 0.1 * w), (0.1, 1e-15) if w == 1.0 else (None, None)
        rows += [
            row(
                f"A at grazing, w = {w}",
                known[0],
                grazing,
                known[1],
                f"closed form {exact:.15g}",
                holds=abs(grazing - exact) < 1e-15,
            ),
            row(
                f"misjudged of {len(flights)} orbits, w = {w}", None, int(wrong), None, note, holds=not wrong
            ),
        ]
        x, y = np.array([(orbit.amplitude * w * w, orbit.speed) for orbit in flights]).T
        curves = [
            Curve(x=x[~through], y=y[~through], name="admissible", line=False),
            Curve(x=x[through], y=y[through], name="pierces the wall", look=1, line=False),
        ]
        panels.append(Panel(title=f"w = {w}", x=("A", "1"), y=("impact speed", "1"), curves=curves))
    return Section(rows=rows, panels=panels, caption="Orbits with one impact a period.")


def sdnd122(run: Run) -> Section:
    """Free oscillation against a spring: frequency over energy e = E/(k gap^2), in units of k and gap."""
    free = replace(driven(0.5, 0.0, Stop(gap=1.0, law=LinearContact(stiffness=5.0))), drive=None)
    e = np.append(0.5 + np.geomspace(1e-6, 1e4, 40 if run.quick else 400), 0.00650108 / 1e-3)
    starts = [contact.State(displacement=x, velocity=0 * x) for x in -np.sqrt(2 * e)[:, None]]
    runs = [contact.simulate(free, start, duration=15.0).impacts for start in starts]
    f = math.sqrt(10) / np.array([np.diff(impacts.start)[0] for impacts in runs])
    angles = np.arccos(-1 / np.sqrt(2 * e)) + np.arccos(np.sqrt(10 / (120 * e - 50))) / math.sqrt(6)
    exact, limit = math.sqrt(10) / (2 * angles), math.sqrt(10) / math.pi / (1 + 1 / math.sqrt(6))
    row = partial(compared, "SDND122")
    rows = [
        row("f at 0.00650108 J", 0.646694, f[-1], 5e-7, f"regularised wall; closed form {exact[-1]:.9f}"),
        row(
            "largest f/f(closed form) - 1",
            None,
            off := float(np.max(np.abs(f / exact - 1))),
            holds=off < 1e-13,
        ),
        row(f"f at e = {e[-2]:.5g}", None, f[-2], note=f"bouncing limit {limit:.9f}"),
    ]
    curves = [
        Curve(x=np.log10(e[:-1]), y=f[:-1], name="simulated"),
        Curve(x=np.log10(e[-1:]), y=[0.646694], name="published", look=1, line=False),
    ]
    panel = Panel(title="", x=(r"$\log_{10}\,E/(k\,gap^2)$", "1"), y=("frequency", "Hz"), curves=curves)
    return Section(rows=rows, panels=[panel], caption="Frequency of free oscillation against a spring.")


def scan(run: Run, a: float, ws: np.ndarray, state: contact.State) -> list[Cell]:
    """w, attractor, largest exponent and strobe points, the state carried along; 3000 periods at each w."""
    found = []
    for w in run.track(ws, f"a = {a}"):
        strobed = StroboscopicMap(oscillator=rig(w, base=a / 1.26))
        try:
            end = orbits.settle(strobed, replace(state, time=0.0), most_cycles=3000)
            name, state = f"p{end.period}/{end.impacts}", replace(end.end, time=0.0)
            if end.period:
                exponents = orbits.orbit_exponents(strobed, state, end.period)
            else:
                exponents, state = orbits.map_exponents(strobed, state, 1000, align=50)
                name = "chaos" if exponents.largest > 3 * exponents.error else "not settled"
            found.append((float(w), name, exponents.largest, end.points[-12:, 0]))
        except contact.ContactError as error:
            run.failed(f"a = {a}, w = {w}", error)
    return found


def aberdeen(run: Run) -> Section:
    """Grazing, and the attractors around it by scans of w (experiments: Ing, Pavlovskaia et al. 2008)."""
    row, rows, panels, step = partial(compared, "Aberdeen rig"), [], [], 2e-4 if run.quick else 2e-5
    for a in (0.7, 0.8, 0.9):
        graze = brentq(lambda w, a=a: 1.26 * rig(w).grazing_amplitude() - a, 0.7, 0.9, xtol=1e-15)
        known = (0.80193, 5e-6) if a == 0.7 else (None, None)
        rows.append(row(f"w at grazing, a = {a}", known[0], graze, known[1]))
        ws, points, exponents = graze + np.arange(-0.0014, 0.003, step) + 0.5 * step, [], []
        below, steady = ws[ws < graze][::-1], StroboscopicMap(oscillator=rig(ws[0], base=a / 1.26)).steady()
        strobed = StroboscopicMap(oscillator=rig(below[0], base=a / 1.26))
        starts = [contact.State(displacement=x, velocity=0 * x) for x in np.linspace(-1, 1, 25)[:, None]]
        ends = (orbits.settle(strobed, start, most_cycles=3000) for start in starts)
        other = next((end.end for end in ends if end.period not in (1, 2, 5)), steady)
        scans = (("up", ws, steady), ("down", ws[::-1], steady), ("coexisting", below, other))
        for look, (words, order, start) in enumerate(scans):
            cells = scan(run, a, order, start)
            chaos = [w for w, name, *_ in cells if name == "chaos"]
            told = ", ".join(f"{name} {next(w)[0]:.5f}" for name, w in groupby(cells, lambda one: one[1]))
            w, _, largest, x = zip(*cells, strict=True)
            band = f"chaos from {min(chaos):.5f} to {max(chaos):.5f}" if chaos else "no chaos"
            rows += [
                row(f"width of chaos in w, a = {a}, {words}", None, step * len(chaos), note=told),
                row(f"largest exponent, a = {a}, {words}", None, max(largest), note=band),
            ]
            exponents.append(Curve(x=w, y=largest, name=words, look=look))
            points.append(Curve(x=np.repeat(w, 12), y=np.concatenate(x), name=words, look=look, line=False))
        panels += [
            Panel(title=f"a = {a}", x=("w", "1"), y=("x/e at the strobe", "1"), curves=points),
            Panel(title="", x=("w", "1"), y=("exponent", "1/period"), curves=exponents),
        ]
    return Section(rows=rows, panels=panels, caption=f"Orbit diagrams and exponents, w in steps of {step}.")
