"""A period-4 orbit against time, one of its collisions from close by, and its spectrum.

Claim (letter 1996, Fig. 4): at F/F_g - 1 = 0.013 the orbit has period 4, and at impact "a multitude of
high-order modes is excited in the beam".

Computed, at 21.50 Hz, where the letter's p1 goes over into p4:

    settled orbit    reached from below grazing; its period is found, not assumed
    motion           tip and read-out point over two periods of the orbit, impacts marked
    close-up         tip relative to the plate and contact force in one collision
    collision        restitution, delay and kick of the single-mode description (contact.collision)
    spectrum         amplitudes of the read-out at the multiples of 1/(orbit period), by FFT over one period
                     of the orbit, so that no window is needed, against the modal frequencies

A motion without a period up to 64 drive periods is drawn and told as such; its spectrum then has leakage.

Run time: some seconds.  Command: python -m studies.time_trace [--excess E] [--frequency HZ].
Outputs: summary.json, time_trace.npz (time, tip, read-out), spectrum.csv, and the figures time_trace and
spectrum as png and pdf.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from typing import Any

from contact.collision import Collision
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import Request, run_study
from studies.instruments.corresponding import corresponding, periods_of
from studies.instruments.options import above
from studies.instruments.oscillators import beam_of
from studies.instruments.quantities import SceneError
from studies.instruments.scene import Scene
from studies.instruments.settled_trace import close_up, settled_state, trace_of
from studies.instruments.spectrum import lines_of, peaks_of
from studies.instruments.spring_of_scene import model_of
from studies.instruments.trace_figure import draw_spectrum, draw_trace
from studies.published import RESTITUTION, TIME_TRACE_EXCESS

FREQUENCY = 21.50
"""Where the letter has the period 4 of its Fig. 4 [Hz]."""

ORBIT_PERIODS = 2
"""Periods of the orbit in the figure."""

APERIODIC = 8
"""Drive periods shown of a motion that has no period."""

MARGIN, SAMPLES = 2.0, 1201
"""Of the close-up: time before and after in contact times (at least 50 us), and samples."""


def told(collision: Collision) -> dict[str, Any]:
    """A collision in terms of JSON."""
    return {
        "time_s": collision.first_touch,
        "approach_velocity": collision.approach,
        "real_approach_velocity": collision.real_approach,
        "restitution": collision.restitution,
        "delay_s": collision.delay,
        "kick": collision.kick,
        "shift_m": collision.shift,
        "impacts": collision.impacts,
        "contact_s": collision.contact_time,
        "ringing_m": collision.ringing,
        "energy_to_higher_modes": collision.energy_to_higher_modes,
        "forced_by_ringing": collision.forced_by_ringing,
        "returns": collision.returns,
    }


def closing_lines(
    period: int, letter: int | None, frequency: float, excess: float, found: Sequence[dict[str, Any]]
) -> list[str]:
    """What was found, and whether it is what the letter shows at this f T."""
    name = f"p{period}" if period else "no period up to 64"
    lines = [
        f"{frequency:g} Hz, excess {excess:g}: {name}"
        + (f"; the letter has p{letter} at this f T" if letter else "")
    ]
    if letter and period != letter:
        lines.append("the settled orbit is not the letter's; what is drawn is what is there")
    if not found:
        lines.append("no impacts: the drive does not reach the plate, or the orbit without impacts is stable")
    for c in found[:1]:
        impacts = f"{c['impacts']} impact{'' if c['impacts'] == 1 else 's'}"
        if not math.isfinite(c["approach_velocity"]):
            lines.append(f"collision: {impacts} that ringing alone makes, no approach of mode 1 to the plate")
            continue
        back = "no restitution or delay (mode 1 does not come back to the plate)"
        if math.isfinite(c["restitution"]):
            back = f"restitution {c['restitution']:.3f} (letter: about {RESTITUTION:g}), "
            back += f"delay {1e3 * c['delay_s']:.3f} ms"
        lines.append(
            f"collision: approach {c['approach_velocity']:.3f} m/s, {back}, kick {c['kick']:.3f}, "
            f"{impacts} in {1e6 * c['contact_s']:.1f} us of contact; ringing left from before "
            f"{1e6 * c['ringing_m']:.1f} um"
        )
    if len(found) > 1:
        lines.append(f"further collisions in the stretch shown: {len(found) - 1}, all in summary.json")
    return lines


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    if scene.drive.kind != "harmonic":
        raise SceneError(f"drive.kind is {scene.drive.kind}; a settled orbit needs a harmonic drive")
    excess = request.options.excess
    asked = request.options.frequency
    frequency = corresponding(scene, FREQUENCY) if asked is None else asked
    letter = periods_of(scene).get(frequency)
    model = model_of(scene)
    scene.replace({"drive.frequencies_hz": (frequency,)}).refuse_drive_above(
        float(model.frequencies_hz.max())
    )
    oscillator = beam_of(scene, frequency, model).with_excess(excess)
    period, state = settled_state(oscillator, max(scene.scan.settle_cycles, 1))
    length = ORBIT_PERIODS * period or APERIODIC
    trace = trace_of(oscillator, state, period, length)
    near = None
    if trace.collisions:
        one = trace.collisions[0]
        near = close_up(oscillator, state, one, max(MARGIN * one.contact_time, 50e-6), SAMPLES)
    # over one period of the orbit: a longer stretch only puts zeros between its lines
    share = ORBIT_PERIODS if period else 1
    lines_hz, amplitude = lines_of(
        trace.readout[: trace.readout.size // share], length / share * oscillator.period
    )
    peaks = peaks_of(lines_hz, amplitude, model.frequencies_hz, frequency)
    found = [told(c) for c in trace.collisions]
    unit, power = ("mm", "m") if scene.readout.quantity == "displacement" else ("mrad", "rad")
    request.record.write_arrays(
        "time_trace", time_s=trace.time, tip_m=trace.tip, **{f"readout_{power}": trace.readout}
    )
    columns = {"frequency_hz": lines_hz.tolist(), f"amplitude_{power}": amplitude.tolist()}
    request.record.write_table("spectrum", columns)
    name = f"p$_{{{period}}}$" if period else "no period"
    title = f"{name}, {frequency:.2f} Hz, $F/F_g - 1$ = {excess:g}"
    if excess == TIME_TRACE_EXCESS:
        title += " (letter: p$_4$)"
    request.record.write_figure(draw_trace(trace, near, scene.stop.gap_m, unit, title), "time_trace")
    request.record.write_figure(
        draw_spectrum(lines_hz, amplitude, model.frequencies_hz, frequency, unit), "spectrum"
    )
    lines = closing_lines(period, letter, frequency, excess, found)
    at_modes = [p for p in peaks if p["mode"] is not None and p["mode"] > 1]
    numbers = ", ".join(str(n) for n in sorted({p["mode"] for p in at_modes}))
    lines.append(f"modes above the first with a peak in the spectrum: {numbers or 'none'}")
    for line in lines:
        print(line, flush=True)
    return {
        "frequency_hz": frequency,
        "excess": excess,
        "period": period,
        "letter": letter if excess == TIME_TRACE_EXCESS else None,
        "impacts": int(round(trace.impact_times.size / ORBIT_PERIODS))
        if period
        else int(trace.impact_times.size),
        "impact_times_s": trace.impact_times,
        "collisions": found,
        "modes_hz": model.frequencies_hz,
        "peaks": peaks,
        "peak_unit": power,
        "closing": lines,
        "failed_cells": 0,
    }


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own options."""
    parser.add_argument(
        "--excess", type=above(-1.0, "a number above -1"), default=TIME_TRACE_EXCESS, metavar="E",
        help=f"F/F_g - 1 of the orbit (default: {TIME_TRACE_EXCESS:g}, the letter's Fig. 4)",
    )
    parser.add_argument(
        "--frequency", type=above(0.0, "a frequency above 0 Hz"), metavar="HZ",
        help=f"drive frequency (default: {FREQUENCY:g} Hz, the letter's p4; other springs at the same f T)",
    )


NEEDS = (Need(quantity="tip_trace", tolerance=2e-3),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "time_trace",
        "A settled orbit against time, one collision from close by, and the spectrum.",
        run,
        argv,
        options=add_options,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
