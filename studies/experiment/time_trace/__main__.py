"""Fig. 4 of the letter: a settled orbit in time, its spectrum, its film.

Claim (letter 1996, Fig. 4): at F/F_g - 1 = 0.013 the orbit has period 4, and at impact "a multitude of
high-order modes is excited in the beam".

Computed, at 21.50 Hz, where the letter's p1 goes over into p4:

    settled orbit    reached from below grazing; its period is found, not assumed
    motion           tip and read-out point over two periods of the orbit, impacts marked
    close-up         tip relative to the plate and contact force in one collision
    collision        restitution, delay and kick of the single-mode description (contact.collisions)
    spectrum         amplitudes of the read-out at the multiples of 1/(orbit period)

The figure says so where a motion has no period up to 64 drive periods; its spectrum then has leakage.
A scene may have several stops, [[stops]]: then impacts are listed by stop in place of collisions, and no
close-up is drawn.

With --film the orbit is filmed, slow at the collision, seen in space (`film`).

Run:     python -m studies time_trace [--excess E] [--frequency HZ] [--film]
Writes:  time_trace.npz, collisions.csv or impacts.csv, spectrum.npz, peaks.csv, time_trace.png, spectrum.png;
         with --film motion.gif, motion.mp4 (extra `video`) and motion.pvd for ParaView
"""

import math
from collections.abc import Mapping, Sequence
from typing import Annotated

from scipy.constants import g

from contact import Collision, StroboscopicMap
from contact.orbits import onset_orbit
from studies import letter
from studies.experiment import film as filming
from studies.experiment import trace as computed
from studies.experiment.period_map import SimulatedMap
from studies.experiment.trace import (
    NEEDS,
    WORDS,
    Peak,
    close_up,
    conditions,
    lines_of,
    peaks_of,
    repeats,
    trace_of,
)
from studies.physics.descriptions import word
from studies.shell.digits import written
from studies.shell.film import MOST_FRAMES
from studies.shell.options import HERTZ, Within
from studies.shell.run import Verdict
from studies.shell.scene import Scene, beam_at, model_of, own_frequency, require_drive_below
from studies.shell.study import Run, study

ORBIT_PERIODS = 2  # periods of the orbit in the figure

APERIODIC = 8  # drive periods shown of a motion that has no period

SHOWN = "first_touch approach restitution delay kick impacts contact_time peak_force ringing".split()
"""Columns of a collision that are shown to a person."""


@study(needs=NEEDS, quick={"frames": 60}, at=conditions, many_stops=True)
def time_trace(
    scene: Scene,
    run: Run,
    *,
    excess: Annotated[float, "F/F_g - 1 of the orbit", Within(-1, 1e6, open=True)] = letter.TIME_TRACE_EXCESS,
    frequency: Annotated[
        float | None,
        "drive frequency (Hz); by default 21.5, or that of the scene with this f T, or its middle one",
        HERTZ,
    ] = None,
    film: Annotated[bool, "film one period of the orbit"] = False,
    frames: Annotated[int, "frames of the film, with --film", Within(1, MOST_FRAMES)] = 240,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    drive_hz = own_frequency(scene, letter.TIME_TRACE_HZ) if frequency is None else frequency
    model = model_of(scene)
    require_drive_below(scene, model, drive_hz)
    oscillator = beam_at(scene, drive_hz, model).with_excess(excess)
    kind, most = SimulatedMap if scene.stops else StroboscopicMap, max(scene.scan.settle_cycles, 1)
    settled = onset_orbit(kind(oscillator=oscillator), excess, most_cycles=most)
    length = ORBIT_PERIODS * settled.m or APERIODIC
    trace = trace_of(oscillator, settled.end, length)
    # over m drive periods: a longer part only puts zeros between the lines
    share = ORBIT_PERIODS if settled.m else 1
    part = trace.readout[: trace.readout.size // share]
    lines_hz, amplitude = lines_of(part, length / share * oscillator.period)
    peaks = peaks_of(lines_hz, amplitude, model.frequencies_hz, drive_hz)
    unit = "rad" if scene.readout.quantity == "rotation" else "m"
    holds = f"time_s from a strobe on [s], tip_m [m] relative to the base, readout_{unit} [{unit}]."
    run.arrays("time_trace", holds, time_s=trace.time, tip_m=trace.tip, **{f"readout_{unit}": trace.readout})
    if scene.stops:
        run.table("impacts", trace.impacts, "Impacts in the part that the figure shows.", of=computed.Touch)
    else:
        collided = "Collisions in the part that the figure shows; one may hold several impacts."
        run.table("collisions", trace.collisions, collided, of=Collision, show=SHOWN, words=WORDS)
    holds = f"Lines of the spectrum: frequency_hz [Hz] and amplitude_{unit} of the read-out [{unit}]."
    run.arrays("spectrum", holds, frequency_hz=lines_hz, **{f"amplitude_{unit}": amplitude})
    peaked = {"amplitude": f"amplitude of the read-out [{unit}]"}
    run.table("peaks", peaks, "Peaks in the spectrum of the read-out.", of=Peak, show=(), words=peaked)
    from studies.experiment.time_trace.figure import draw_spectrum, draw_trace  # matplotlib is slow to import

    name, impacts = word(settled.m), round(trace.impact_times.size / share)
    near = close_up(oscillator, settled.end, trace.collisions[0]) if trace.collisions else None
    run.figure(
        "time_trace",
        draw_trace(trace, near, oscillator.stops, unit, f"{name}, {drive_hz:.2f} Hz"),
        "Ball and read-out point of the settled motion against time, and a collision from close by.",
    )
    run.figure(
        "spectrum",
        draw_spectrum(lines_hz, amplitude, model.frequencies_hz, drive_hz, unit),
        "Spectrum of the read-out over one period of the orbit.",
    )
    amplitude_m = oscillator.driven.amplitude
    size_g = amplitude_m * oscillator.driven.angular_frequency**2 / g
    run.say(f"{drive_hz:g} Hz, excess {excess:g}, base {1e3 * amplitude_m:.4g} mm, {size_g:.3g} g: {name}")
    higher = sorted({peak.mode for peak in peaks if peak.mode is not None and peak.mode > 1})
    findings(run, settled.m, impacts, trace.collisions, higher)
    if scene.stops:
        run.finding("The spring has several stops: impacts are listed instead of collisions.")
    filmed = dict[str, object]()
    if film:
        words = f"base shaken at {drive_hz:.4g} Hz with {1e3 * amplitude_m:.3g} mm: {repeats(settled.m)}"
        filmed["film"] = filming.film(scene, run, oscillator, settled, trace, words, frames=frames)
    seen = letter.PERIODS.get(drive_hz) if run.letters and excess == letter.TIME_TRACE_EXCESS else None
    if seen == letter.PERIODS[letter.TIME_TRACE_HZ]:
        judge(run, name, seen, trace.collisions, higher)
    return {
        "rows": trace.impacts if scene.stops else trace.collisions,
        "frequency_hz": drive_hz,
        "excess": excess,
        "drive_amplitude_m": amplitude_m,
        "drive_acceleration_g": size_g,
        "m": settled.m,
        "letter": seen,
        "impacts": impacts,
        "impact_times_s": trace.impact_times,
        "modes_hz": model.frequencies_hz,
        "peaks": peaks,
        "peak_unit": unit,
        **filmed,
    }


def findings(run: Run, m: int, impacts: int, found: Sequence[Collision], higher: Sequence[int]) -> None:
    """The findings."""
    touches = ("" if impacts else " and never touches the plate") if impacts != 1 else ", with one impact"
    run.finding(f"{repeats(m).capitalize()}{touches}.")
    if found and math.isfinite(found[0].restitution):
        left = written(found[0].restitution, 2)
        words = "times its approach velocity; higher modes ring with the rest"
        run.finding(f"Mode 1 leaves a collision with {left} {words}.")
    if found and higher:
        run.finding(f"The spectrum has a peak at {len(higher)} of the higher modes.")


def judge(run: Run, period: str, seen: int, found: Sequence[Collision], higher: Sequence[int]) -> None:
    """Verdicts on Fig. 4."""
    run.verdict("time_trace", "agrees" if period == f"p{seen}" else "differs", found=period)
    verdict: Verdict = "agrees" if len(higher) > 2 else "in part" if higher else "differs"
    said = f"modes {', '.join(map(str, higher))} have" if higher else "no mode above the first has"
    run.verdict("many_modes", verdict, found=f"{said} a peak in the spectrum", figure="spectrum")
    if found and math.isfinite(found[0].restitution):
        near = abs(found[0].restitution - letter.RESTITUTION) <= 0.5 * letter.RESTITUTION
        note = f"Time delay {written(1e3 * found[0].delay)} ms, kick {written(found[0].kick)}."
        verdict, said = "agrees" if near else "differs", written(found[0].restitution, 3)
        run.verdict("restitution_on_orbit", verdict, found=said, note=note)
