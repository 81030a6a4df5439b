r"""A wall of finite hardness: how the square root is smoothed, and what orbit that adds at grazing.

Claim (letter 1996, last page): a wall "such that at impact the spring constant changes by a factor K >> 1"
affects the bifurcations close to grazing in a characteristic manner, to larger amplitudes the smaller K; the
experiment did not show it.

Computed, for Eq. (1) with a wall of K times the spring constant, without loss and with the dashpot that gives
a hard approach the letter's restitution, at each drive frequency and K = 10 ... 10^6:

    kick       of one collision against the peak h over the wall: J = (4/3) (K - 1) Omega^2 sqrt(2/a) h^(3/2)
               below h = (3/2) a/((K - 1) Omega^2), a = omega^2 gap, and the square root above; with a dashpot
               J = c h below
    doubling   excess at which p1, which survives its first touch, loses stability by a multiplier -1: on the
               simulated period map, against  h_f [1 + (2/3)(1 + gamma + alpha)/(1 - alpha + gamma)],
               h_f = (omega^2/2) [(1 + gamma + alpha)/(2 M12 K Omega^2)]^2 (gap 1) for K -> infinity, and
               against a closed form for finite K; settled motions on both sides
    hysteresis excess at which p_m ends, m as at that frequency in the map: fold of the simulated map, a
               downward scan, and the hard wall (closed form), from which it lies at a distance K^(-1/2)

and for the beam with Hertz contact the excess at which the kick leaves the square root, the orbit born below
it and whether the letter could have seen it.  The equations are derived in `soft_impact`, `contact_orbits`
and `hertz_smoothing` of `studies.instruments.soft_wall`.

Run time: three quarters of a minute; --quick ten seconds.  Command: python -m studies.soft_wall.  Outputs:
summary.json, rows.csv, kicks.csv, beam.csv, beam_born.csv; kick, doubling, hysteresis and beam (png, pdf).
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from contact.errors import ContactError
from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.command_line import Request, run_study
from studies.instruments.oscillators import beam_of, hertz_of
from studies.instruments.scene import Scene
from studies.instruments.soft_wall.figures import draw_beam, draw_doubling, draw_hysteresis, draw_kicks
from studies.instruments.soft_wall.hertz_smoothing import (
    HertzSmoothing,
    born_orbits,
    collision_above,
    doubling_excess,
    local_slope,
    reach_of,
)
from studies.instruments.soft_wall.measures import Case, curve_of, hysteresis_chain, row_of, theory_lines
from studies.instruments.soft_wall.soft_impact import damping_ratio
from studies.instruments.soft_wall.words import HEAD, RESOLUTION, answers_of, table_line
from studies.instruments.spring_of_scene import model_of
from studies.published import TIME_TRACE_EXCESS

SCHEMA = 1

HARDNESSES = (1e1, 1e2, 1e3, 1e4, 1e5, 1e6)
QUICK_HARDNESSES = (1e2, 1e4, 1e6)
SHOWN = 22.2
"""Frequency of the curves and of the beam, or the one of the scene nearest to it [Hz]."""

QUICK_FREQUENCIES = (22.2, 22.6)


def beam_part(scene: Scene, frequency: float, quick: bool) -> dict[str, Any]:
    """The beam with Hertz contact at one frequency."""
    scene = scene.replace({"contact.law": "hertz"}, provenance="Hertz contact")
    oscillator = beam_of(scene, frequency, model_of(scene))
    theory = HertzSmoothing(oscillator=oscillator)
    excesses = np.geomspace(1e-7, 1e-1, 13 if quick else 37)
    collisions = [collision_above(oscillator, float(e)) for e in excesses]
    speed = np.array([c.kick_velocity for c in collisions])
    drive = oscillator.drive
    assert drive is not None
    approach = drive.angular_frequency * oscillator.stop.gap * np.sqrt(excesses * (2.0 + excesses))
    plateau = collision_above(oscillator, TIME_TRACE_EXCESS).kick

    def half(excess: float) -> float:
        return collision_above(oscillator, excess).kick - 0.5 * plateau

    half_excess = reach_of(half, 1e-8, 1e-2)
    predicted = theory.doubling()
    measured = (
        doubling_excess(oscillator, 0.2 * predicted, 10.0 * predicted, 600 if quick else 2500)
        if predicted
        else None
    )
    born = born_orbits(oscillator, np.geomspace(1e-7, 1e-2, 11 if quick else 26), 4000)
    others = {
        f"{f:g}": HertzSmoothing(oscillator=beam_of(scene, f, oscillator.model)).doubling()
        for f in sorted(set(scene.drive.frequencies_hz))
    }
    return {
        "frequency_hz": frequency,
        "doubling_theory_by_frequency": others,
        "modes": oscillator.n_modes,
        "excess": excesses,
        "kick_velocity": speed,
        "kick": [c.kick for c in collisions],
        "slope": [local_slope(oscillator, float(e)) for e in excesses],
        "soft_law": [theory.kick_velocity(float(e)) for e in excesses],
        "hard_law": plateau * approach,
        "contact_time_s": [c.contact_time for c in collisions],
        "restitution": [c.restitution for c in collisions],
        "plateau": plateau,
        "half_excess": half_excess,
        "square_root_from": reach_of(lambda e: local_slope(oscillator, e) - 0.6, 1e-5, 1e-1),
        "square_law_up_to": reach_of(lambda e: local_slope(oscillator, e) - 1.9, 1e-7, 1e-3),
        "doubling_theory": predicted,
        "doubling_excess": None if measured is None else measured[0],
        "period_beyond": None if measured is None else measured[1],
        "born": born,
        "resolution": RESOLUTION,
        "hertz_stiffness": hertz_of(scene).stiffness,
    }


def hardnesses_of(request: Request) -> tuple[float, ...]:
    """The K asked for, or the usual ones."""
    asked = request.options.hardness
    if asked:
        return tuple(sorted(set(asked)))
    return QUICK_HARDNESSES if request.quick else HARDNESSES


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; a soft wall needs a harmonic drive")
    if scene.single_mode.restitution == 0.0:
        raise ValueError(
            "single_mode.restitution is 0.0; a wall with spring and dashpot needs one above zero"
        )
    hardnesses, quick = hardnesses_of(request), request.quick
    frequencies = sorted(set(scene.drive.frequencies_hz))
    shown = min(frequencies, key=lambda f: abs(f - SHOWN))
    if quick:
        frequencies = sorted({min(frequencies, key=lambda f: abs(f - g)) for g in QUICK_FREQUENCIES})
    zeta = damping_ratio(scene.single_mode.restitution)
    zetas = (0.0, zeta) if zeta > 0.0 else (0.0,)
    cases = [
        Case(scene=scene, frequency=f, hardness=K, zeta=z)
        for f in frequencies
        for z in zetas
        for K in hardnesses
    ]
    chains = sorted({(case.frequency, case.zeta) for case in cases})
    excesses = np.geomspace(1e-8, 3e-2, 14 if quick else 27)
    shown_cases = [case for case in cases if case.frequency == shown]
    with (
        ThreadPoolExecutor(max_workers=request.workers) as pool,
        request.progress("soft wall", total=len(cases) + len(chains) + len(shown_cases) + 1) as progress,
    ):

        def counted(work: Callable[..., Any], *arguments: Any) -> Any:
            result = work(*arguments)
            progress.advance()
            return result

        beam_job = pool.submit(counted, beam_part, scene, shown, quick)
        chain_jobs = {
            key: pool.submit(counted, hysteresis_chain, scene, *key, hardnesses, not quick) for key in chains
        }
        curve_jobs = [pool.submit(counted, curve_of, case, excesses) for case in shown_cases]
        chained = {key: job.result() for key, job in chain_jobs.items()}
        row_jobs = [
            pool.submit(counted, row_of, case, chained[case.frequency, case.zeta][0][case.hardness])
            for case in cases
        ]
        curves = [job.result() for job in curve_jobs]
        rows = [job.result() for job in row_jobs]
        failures = [sentence for row in rows for sentence in row.pop("failures")]
        beam: dict[str, Any] | None = None
        try:
            beam = beam_job.result()
        except ContactError as error:
            failures.append(f"beam: {error}")
    print(HEAD)
    for row in rows:
        print(table_line(row))
    exponents = {
        f"{f:g} Hz, {'dashpot' if z else 'lossless'}": found for (f, z), (_rows, found) in chained.items()
    }
    answers = answers_of(scene, rows, curves, exponents, beam)
    store(request, rows, curves, beam)
    request.record.write_figure(draw_kicks(curves, RESOLUTION), "kick")
    lossless = [row for row in rows if row["case"] == "lossless"]
    request.record.write_figure(
        draw_doubling(lossless, theory_lines(scene, frequencies), RESOLUTION), "doubling"
    )
    request.record.write_figure(draw_hysteresis(rows), "hysteresis")
    if beam is not None:
        request.record.write_figure(draw_beam(beam, RESOLUTION), "beam")
    for line in [*failures, *answers["sentences"]]:
        print(line, flush=True)
    return {
        "soft_wall_schema": SCHEMA,
        "rows": rows,
        "beam": beam,
        "answers": answers,
        "failures": failures,
        "failed_cells": len(failures),
    }


def store(
    request: Request, rows: Sequence[Mapping[str, Any]], curves: Any, beam: Mapping[str, Any] | None
) -> None:
    """The tables."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    request.record.write_table("rows", {key: [row.get(key) for row in rows] for key in columns})
    names = ("excess", "kick_velocity", "closed_form", "soft_law", "hard_law")
    table: dict[str, list[Any]] = {"K": [], "case": [], **{name: [] for name in names}}
    for curve in curves:
        table["K"] += [curve["K"]] * len(curve["excess"])
        table["case"] += [curve["case"]] * len(curve["excess"])
        for name in names:
            table[name] += list(curve[name])
    request.record.write_table("kicks", table)
    if beam is not None:
        columns = [
            key for key, value in beam.items() if np.size(value) == np.size(beam["excess"]) and key != "born"
        ]
        request.record.write_table("beam", {key: beam[key] for key in columns})
        born = beam["born"]
        request.record.write_table("beam_born", {key: [row[key] for row in born] for key in born[0]})


def hardness(text: str) -> float:
    """A hardness from the command line."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 2.0 <= value <= 1e7:
        raise argparse.ArgumentTypeError(f"must be a number from 2 to 1e7, not {text!r}")
    return value


def add_options(parser: argparse.ArgumentParser) -> None:
    """The study's own option."""
    parser.add_argument(
        "--hardness",
        type=hardness,
        nargs="+",
        metavar="K",
        help="hardness of the wall, 2 to 1e7, one or more (default: 10 to 1e6 in decades)",
    )


NEEDS = (Need(quantity="kick", tolerance=0.005, mesh=False),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "soft_wall",
        "A wall of K times the spring constant: the smoothed square root and the orbits that it adds.",
        run,
        argv,
        options=add_options,
        needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
