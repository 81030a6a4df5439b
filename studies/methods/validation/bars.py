"""Uniform bars against a wall and against each other: u'' = c^2 u_xx, mass m, T = L/c, impedance J = m/T.

A force F(t) on one end moves that end with (F(t) + 2 sum_n s^n F(t - 2 n T))/J, s = 1 if the far end is free
and -1 if it is held: both exact motions follow.  Modes, omega T and phi sqrt(m) at the end: k pi and sqrt(2),
1 for k = 0 (free), (k + 1/2) pi (held); or those of linear elements, int u' v' = omega^2 int u v.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
import skfem as sk
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.special import lambertw

from beam import ModalModel
from contact import ContactError, HarmonicDrive, ImpactOscillator, LinearContact, State, Stop, simulate
from contact.orbits import PeriodicOrbit
from studies.methods.validation.responses import drawn, followed, motion
from studies.methods.validation.rows import Curve, Panel, Section, compared
from studies.shell.run import Run

Array = NDArray[np.float64]
FALL, GRAVITY, TRANSIT, MASS = 5.0, 10.0, 1.0 / 3.0, 10.0  # m, m/s^2, s, kg of the bouncing bar
STEPS = 30  # in a transit: its touches and releases, at 3, 5, 11 and 13 T, are whole numbers of them
PRINTED = {0.2: -0.1, 0.4: -0.2, 0.6: -0.1, 0.8: 0.0, 1.0: 0.2}  # ms, mm: contact end of two bars
WALLS = (0.4, 4.0, 20.0, 40.0)  # stiffness over E A/L


def series(count: int, held: bool) -> tuple[Array, Array]:
    """The first exact modes."""
    k = np.array([i + 0.5 * held for i in range(count)])
    return math.pi * k, np.where(k == 0.0, 1.0, math.sqrt(2.0))


def elements(count: int, held: bool) -> tuple[Array, Array]:
    """All modes of `count` linear elements."""
    basis = sk.Basis(sk.MeshLine(np.linspace(0.0, 1.0, count + 1)), sk.ElementLineP1())
    weak = sk.BilinearForm(lambda u, v, _: u.grad[0] * v.grad[0]), sk.BilinearForm(lambda u, v, _: u * v)
    left = count if held else count + 1
    squares, shapes = eigh(*(form.assemble(basis).toarray()[:left, :left] for form in weak))
    squares[: left - count] = 0.0
    return np.sqrt(squares), np.abs(shapes[0])


def lower_end(transits: int) -> Array:
    """Height of the lower end over a rigid floor at multiples of T/STEPS [m]: there F/J cancels the fall."""
    step, heights, push = TRANSIT / STEPS, [FALL], np.zeros((transits + 2) * STEPS)
    for i in range(transits * STEPS):  # all is linear in a step: its middle is exact
        speed = 2.0 * push[i :: -2 * STEPS].sum() - GRAVITY * (i + 0.5) * step
        if heights[-1] < 1e-9 and speed < 0.0:
            push[i + 2 * STEPS], speed = -speed, 0.0
        heights.append(heights[-1] + speed * step)
    return np.array(heights)


def bounced(modes: tuple[Array, Array], times: Array) -> Array:
    """Height of the lower end over a floor of stiffness J omega_max [m]."""
    omega, phi = modes[0] / TRANSIT, modes[1] / math.sqrt(MASS)
    whole = np.where(omega == 0.0, math.sqrt(MASS), 0.0)
    stop = Stop(gap=0.0, law=LinearContact(stiffness=MASS / TRANSIT * float(omega[-1])))
    model = ModalModel(omega=omega, decay_rate=0.0 * omega, phi=phi, participation=0.0 * omega)
    bar = ImpactOscillator(model=model, stop=stop, load=GRAVITY * whole)
    start = State(displacement=-FALL * whole, velocity=0.0 * whole)
    return -(simulate(bar, start, duration=times[-1], times=times).displacement @ phi)


def bouncing_bar(run: Run) -> Section:
    """Free bar dropped on a floor (Doyen, Ern and Piperno; NLstep example 01): periodic with 16 L/c."""
    exact, counts = lower_end(16), np.array([16, 32, 64] if run.quick else [16, 32, 64, 128, 256])
    times, name = np.linspace(0.0, 16.0 * TRANSIT, exact.size), "bouncing bar"
    back = float(exact[-1])
    rows = [
        compared(
            name,
            "height after 16 L/c [m]",
            None,
            back,
            None,
            "by characteristics; from 5 m",
            holds=abs(back - FALL) < 1e-9,
        )
    ]
    curves = [Curve(x=times, y=exact, name="exact")]
    for look, (words, modes) in enumerate((("exact modes", series), ("linear elements", elements)), 1):
        found = [bounced(modes(int(n), False), times) for n in run.track(counts, words)]
        errors = [float(np.sqrt(np.mean((heights - exact) ** 2))) for heights in found]
        power = float(np.polyfit(np.log(counts), np.log(errors), 1)[0])
        what = f"mean error, {counts[-1]} {words} [m]"
        rows.append(compared(name, what, None, errors[-1], note=f"as their number^{power:.2f}"))
        curves.append(Curve(x=times, y=found[1], name=f"{counts[1]} {words}", look=look))
    panel = Panel(title="", x=("time", "s"), y=("height of the lower end", "m"), curves=curves)
    return Section(rows=rows, panels=[panel], caption="A bar dropped on a rigid floor.")


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


def two_bars(run: Run) -> Section:
    """Two bars of 1 m tip to tip, the far end of the second held (SDNL111 of code_aster)."""
    name, root, wave, stiffness, count = "SDNL111", math.sqrt(3.12), math.sqrt(2e11 / 7800.0), 5e9, 400
    (free, tip), (held, other), times = series(count, False), series(count, True), np.linspace(0.0, 1e-3, 501)
    omega, phi = wave * np.append(free, held), np.append(-tip, other) / root  # positive when they approach
    model = ModalModel(omega=omega, decay_rate=0.0 * omega, phi=phi, participation=0.0 * omega)
    bars = ImpactOscillator(model=model, stop=Stop(gap=0.0, law=LinearContact(stiffness=stiffness)))
    start = State(displacement=0.0 * omega, velocity=-root * (np.arange(omega.size) == 0))
    found = simulate(bars, start, duration=1e-3, times=times).displacement[:, :count] @ tip / root
    exact = met(times, 1.0 / wave, 0.5 * root**2 * wave / stiffness)
    rows = [compared(name, f"largest error, 2 x {count} modes [m]", None, float(np.abs(found - exact).max()))]
    for time, printed in PRINTED.items():
        i, error = round(500 * time), 0.05e-3 * abs(printed or 0.2)  # at zero 5 % of the largest
        what, note = f"contact end at {time} ms [m]", f"exact wave {exact[i]:.4e}"
        rows.append(compared(name, what, 1e-3 * printed, float(found[i]), error, note))
    points = Curve(x=list(PRINTED), y=list(PRINTED.values()), name="printed", look=2, line=False)
    curves = [Curve(x=1e3 * times, y=1e3 * found, name="modes"), points]
    panel = Panel(title="", x=("time", "ms"), y=("contact end of the first bar", "mm"), curves=curves)
    return Section(rows=rows, panels=[panel], caption="Two bars tip to tip; the first came at 1 m/s.")


def at_wall(modes: tuple[Array, Array], wall: float, rate: float) -> ImpactOscillator:
    """The clamped bar driven at `rate` [rad/s] by 25 kN on its tip, 0.2 mm from a wall of `wall` E A/L."""
    wave, mass, gap = math.sqrt(210e9 / 7800.0) / 0.13, 7800.0 * 15.6e-4 * 0.13, 2e-4
    omega, phi = wave * modes[0], modes[1] / math.sqrt(mass)
    model = ModalModel(omega=omega, decay_rate=0.015 * omega, phi=phi, participation=phi)
    stop = Stop(gap=gap, law=LinearContact(stiffness=wall * mass * wave**2))
    drive = HarmonicDrive(frequency=rate / (2.0 * math.pi), amplitude=25e3 / rate**2)
    return ImpactOscillator(model=model, stop=stop, drive=drive)


def half_span(orbit: PeriodicOrbit) -> float:
    """Half the span of the tip over the gap."""
    tip = orbit.oscillator.tip(motion(orbit)[1])
    return float(np.ptp(tip)) / (2.0 * orbit.oscillator.stop.gap)


def bar_at_wall(run: Run) -> Section:
    """Clamped-free bar against an elastic wall (Vadcard, Batailly, Thouverez 2022): response curves to where
    they turn round."""
    rows, panels = [], []
    known = {"20 elements": elements(20, True)}
    if not run.quick:
        known["40 exact modes"] = series(40, True)
    for words, modes in known.items():
        curves = []
        for look, wall in enumerate(run.track(WALLS[:2] if run.quick else WALLS, words)):
            what = f"turning frequency, wall {wall:g} EA/L, {words} [rad/s]"
            try:
                found = followed(partial(at_wall, modes, wall), 6.25e4, low=5.8e4, high=7.4e4, step=0.15)
            except ContactError as error:
                run.failed(what, error)
                continue
            turns = [event for event in found.events if event.kind == "fold"]
            last = max(turns, key=lambda event: event.parameter or 0.0)
            note = f"{half_span(last.orbit):.2f} gaps"
            rows.append(compared("bar at a wall", what, None, last.parameter, note=note))
            stable, unstable = drawn(found, half_span, 1e3, look)
            curves += [replace(stable, name=f"{wall:g} EA/L"), replace(unstable, name="")]
        panels.append(Panel(title=words, x=("frequency", "krad/s"), y=("half span", "gaps"), curves=curves))
    caption = "A bar at a wall, pale where unstable; 20 elements are few at stiff walls."
    return Section(rows=rows, panels=panels, caption=caption)
