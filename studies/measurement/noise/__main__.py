"""Fig. 3 as an experiment with a noisy drive would see it, and why p10 was the last period.

Claims (letter 1996): "the measured hysteresis differs from the prediction"; the amplitude has a long-term
stability of 0.5 um of 2 mm, 2.5e-4; p10 "is at the limit of our experimental resolution and stability".

The printed stability speaks of slow drift; white noise is an assumption. Here both are standard deviations of
the amplitude, which is constant from strobe to strobe; correlation times, steps and waiting are options (the
letter prints 1e4 cycles with Fig. 5 alone, steps nowhere).

Computed: clouds of strobe points against C = M C M^T + Q and their growth
(studies.measurement.noise.covariances); many scans of Eq. (1) along Fig. 3, and of the beam at the letter's
frequencies (studies.measurement.noise.scans); the same by formulas (studies.measurement.noise.rates); which
p_m can be told apart and live (studies.measurement.noise.last_period). The observed hysteresis is the excess
at which p_1 is left less that at which p_m is lost.

Run:     python -m studies noise [--stability X] [--correlation-times S ...]
Writes:  covariances.csv, growth.csv, escape.csv (a row an end of an orbit: quantiles of the excess, simulated
         and by formula), observed.csv (a row a frequency, period and noise), both also *_at_letter.csv,
         last_period.csv, the scans and their seed (scans-*, where a run that was stopped goes on), and the
         figures observed and escape
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from typing import Annotated

import numpy as np

from beam import InvalidValue, ModalModel
from contact import StroboscopicMap
from contact.orbits import born
from studies.letter import AMPLITUDE_STABILITY, PERIODS, SETTLE_CYCLES
from studies.measurement.noise.covariances import MEMORIES_S, covariance_of, growth_of
from studies.measurement.noise.ends import Observed, ends_of, observed_of
from studies.measurement.noise.last_period import LastPeriod, frequency_of, in_noise
from studies.measurement.noise.places import Place
from studies.measurement.noise.scans import Protocol, cell, named
from studies.shell.files import fingerprint
from studies.shell.scene import (
    Scene,
    band_of,
    beam_at,
    corresponding,
    harmonic,
    model_of,
    periods_of,
    single_mode_at,
)
from studies.shell.study import Run, study
from studies.shell.sweep import sweep

LOWEST_HZ, HIGHEST_HZ, BANDS = 19.6, 23.8, range(3, 11)
"""Of Fig. 3."""

FEWEST = 10
"""Scans at least."""

CLOUD_PERIOD, HIGHEST = 3, max(PERIODS.values())

CLOUD_PERIODS, TOLD, PLACES = (1_000_000, 50_000), (range(3, 17), range(8, 12)), ((0.1, 4), (0.5, 2))
"""Drive periods for a covariance; m that are told apart; Hz between places in a band, and places at least:
the full form, the small one."""


@study(needs={"fold": 0.05}, quick={"scans": 10, "correlation_times": (0.0, 100.0)})
def noise(
    scene: Scene,
    run: Run,
    *,
    stability: Annotated[float, "standard deviation of the amplitude, relative"] = AMPLITUDE_STABILITY,
    correlation_times: Annotated[tuple[float, ...], "of its drift (s), 0 for white"] = (0.0, 100.0, 3600.0),
    amplitude_step: Annotated[float, "of a scan, relative"] = AMPLITUDE_STABILITY,
    waiting: Annotated[int, "drive periods at each amplitude"] = SETTLE_CYCLES,
    readout: Annotated[float, "standard deviation of a reading of the displacement (m)"] = 0.0,
    scans: Annotated[int, "up and down at each frequency, a fifth of them for the beam"] = 100,
    seed: Annotated[int, "of all noise"] = 1996,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    protocols = [
        Protocol(step=amplitude_step, waiting=waiting, stability=stability, correlation_s=time)
        for time in dict.fromkeys(correlation_times)
    ]
    if not readout >= 0.0:
        raise InvalidValue(f"readout is {readout:g} m; it must be 0 or more")
    if scans < FEWEST:
        raise InvalidValue(f"scans is {scans}; quantiles need at least {FEWEST}")
    model, letters = model_of(harmonic(scene)), letter_periods(scene)
    clouds(scene, run, model, seed)

    along = places(scene, model, letters, *PLACES[run.quick])
    cells = [(place, each) for place in along for each in protocols]
    settings = {
        "seed": seed,
        "scans": scans,
        "protocols": [asdict(each) for each in protocols],
        "places": [[place.description, place.frequency_hz, place.m] for place in along],
    }
    own = fingerprint(run.scene.values(), settings)[:12]
    found = sweep(run, f"scans-{own}", settings, cells, partial(cell, scans, seed))
    made = [(*where, one) for where, one in zip(cells, found, strict=True) if one is not None]
    ends = [row for rows in run.attempt(ends_of, made, "ends") for row in rows or ()]
    observed = [row for one in made if (row := observed_of(one)) is not None]
    at_letter = [row for row in ends if (row.frequency_hz, row.m) in letters]
    shown = [row for row in observed if (row.frequency_hz, row.m) in letters]
    off = [row.off**2 for row in ends if row.off is not None]
    run.table("escape", ends, "Excess at which p_m and p_1 end, simulated and by formula.", show=())
    run.table(
        "escape_at_letter",
        at_letter,
        "The same at the letter's frequencies; along Fig. 3 formulas "
        f"are {np.sqrt(np.mean(off or np.nan)):.2f} standard errors off (rms of {len(off)} medians).",
    )
    run.table("observed", observed, "Hysteresis along Fig. 3 as an observer would measure it.", show=())
    run.table("observed_at_letter", shown, "The same at the letter's frequencies.")

    described = [
        ("Eq. (1)", StroboscopicMap(oscillator=single_mode_at(scene, frequency_of(scene, m))), m)
        for m in TOLD[run.quick]
    ]
    described += [
        ("beam", StroboscopicMap(oscillator=beam_at(scene, f, model)), m)
        for f, m in letters[-2 if run.quick else 0 :]
    ]
    asked = partial(in_noise, readout, protocols, seed)
    last = [row for row in run.attempt(asked, described, "periods in noise") if row]
    kinds = [named(each.correlation_s) for each in protocols]
    run.table(
        "last_period",
        last,
        "Which p_m can be told apart at an excess of 1e-3, and lives where it is "
        f"born; for each kind of noise: {', '.join(kinds)}.",
    )
    from studies.measurement.noise import figure  # matplotlib is slow to import

    if observed:
        run.figure("observed", figure.draw_observed(scene, observed), figure.OBSERVED)
    if at_letter:
        run.figure("escape", figure.draw_escape(at_letter), figure.ESCAPE)
    answer_hysteresis(run, protocols, observed)
    merged = judge(run, kinds, last)
    return {"ends": ends, "observed": observed, "last_period": last, "first_merged": merged}


def clouds(scene: Scene, run: Run, model: ModalModel, seed: int) -> None:
    """Covariances and their growth."""
    periods = CLOUD_PERIODS[run.quick]
    m, edge = CLOUD_PERIOD, band_of(scene, CLOUD_PERIOD).upper
    frequency = next(f for f, born in periods_of(scene).items() if born == m)
    names = ("map", "Eq. (1)", "beam")
    pairs = [(at(scene, model, name, m, frequency), at(scene, model, name, m, edge)) for name in names]
    cases = [(place, time) for place, _edge in pairs for time in MEMORIES_S]
    found = [row for row in run.attempt(partial(covariance_of, periods, seed), cases, "covariances") if row]
    run.table("covariances", found, f"Simulated covariances of the points of p{m} over the predicted ones.")
    grown = run.attempt(partial(growth_of, periods, seed), pairs, "growth of clouds")
    run.table(
        "growth",
        [row for rows in grown for row in rows or ()],
        "Exponents with which clouds grow; expected: at a hard stop.",
    )


def at(scene: Scene, model: ModalModel, description: str, m: int, frequency_hz: float) -> Place:
    """A place in one description."""
    own = model if description == "beam" else None
    return Place(scene=scene, description=description, m=m, frequency_hz=frequency_hz, model=own)


def letter_periods(scene: Scene) -> list[tuple[float, int]]:
    """The frequencies of the scene, by default the letter's, at which p_m of Eq. (1) is born, with m."""
    found = []
    for f in sorted(scene.drive.frequencies_hz):
        orbit = born(StroboscopicMap(oscillator=single_mode_at(scene, f)), AMPLITUDE_STABILITY)
        found += [(f, orbit.period)] if orbit.period > 1 and orbit.impacts == 1 else []
    return found


def places(
    scene: Scene, model: ModalModel, letters: Sequence[tuple[float, int]], spacing_hz: float, least: int
) -> list[Place]:
    """p_m of Eq. (1) along the bands of Fig. 3, of Eq. (1) and the beam at the letter's frequencies."""
    found = dict.fromkeys(letters)
    for m in BANDS:
        edges = band_of(scene, m)
        low = max(edges.lower, corresponding(scene, LOWEST_HZ))
        high = min(edges.upper, corresponding(scene, HIGHEST_HZ))
        count = max(least, int(np.ceil((high - low) / spacing_hz)))
        grid = high - (high - low) * (np.arange(count) + 0.5) / count
        found |= {(round(float(f), 4), m): None for f in grid if high > low}
    singles = [at(scene, model, "Eq. (1)", m, f) for f, m in sorted(found)]
    return singles + [at(scene, model, "beam", m, f) for f, m in letters]


def answer_hysteresis(run: Run, protocols: Sequence[Protocol], observed: Sequence[Observed]) -> None:
    """What noise does to the hysteresis of Eq. (1), in the fastest drift, or in white noise without one."""
    drifts = sorted(each.correlation_s for each in protocols if each.correlation_s)
    kind = named(drifts[0] if drifts else 0.0)
    rows = [row for row in observed if row.noise == kind and row.description == "Eq. (1)"]
    met = [row for row in rows if np.isfinite(row.median)]
    whole = [row for row in met if row.map is not None and row.fold > protocols[0].stability]
    if not whole:
        return
    shift = np.array([row.median - row.fold for row in whole])
    part = np.abs(shift) / (np.abs(shift) + np.abs([row.fold - (row.map or 0.0) for row in whole]))
    width = np.median([row.high - row.low for row in whole])
    given = [row for row in met if row.frequency_hz in run.scene.drive.frequencies_hz]
    told = [f"{row.frequency_hz:.2f} Hz {row.median / row.fold - 1.0:+.0%}" for row in given if row.seen]
    hidden = [f"p{row.m} at {row.frequency_hz:.2f} Hz" for row in given if not row.seen]
    below = [band_of(run.scene, row.m).upper - row.frequency_hz for row in met if not row.seen]
    missed = len(rows) - len(met)
    drowned = f" and hides it at {len(below)} of {len(rows)} places along Fig. 3" if below else ""
    drowned += f", all within {max(below):.2g} Hz of the upper edge of a band" if below else ""
    drowned += f" ({', '.join(hidden)})" if hidden else ""
    run.answer(
        "hysteresis",
        f"Noise of {protocols[0].stability:.2g} of the amplitude ({kind}) changes the hysteresis that an "
        f"observer measures by {np.median(shift):+.1e} (median of {len(whole)} folds; 5 to 95 % of his scans "
        f"span {width:.1e}){': ' + ', '.join(told) + ',' if told else ''}{drowned}. {np.median(part):.0%} "
        "(median) of what separates his hysteresis in Eq. (1) from the map's is noise, the rest the map's "
        "own truncation."
        + (
            f" At {missed} of {len(rows)} places p_m is not reached: the scan from above grazing ends in "
            "p1 before, or noise throws it over a second touch."
            if missed
            else ""
        ),
    )


def judge(run: Run, kinds: Sequence[str], last: Sequence[LastPeriod]) -> dict[str, int | None]:
    """Verdict and answer on the last period; first m of Eq. (1) whose clouds merge in each noise."""
    of_eq_1 = [row for row in last if row.description == "Eq. (1)" and row.told_apart]
    merged = {
        kind: next((row.m for row in of_eq_1 if row.told_apart and not row.told_apart[k] >= 1.0), None)
        for k, kind in enumerate(kinds)
    }
    first = merged[kinds[0]]
    run.verdict(
        "last_period",
        "agrees" if first is not None and 0 <= first - HIGHEST <= 1 else "in part",
        found=", ".join(f"{f'p{m}' if m else 'none'} ({kind})" for kind, m in merged.items()),
        note="first period whose closest strobe points merge in noise of the amplitude's stability",
    )
    sharp = {kind: [row.m for row in of_eq_1 if row.seen[k]] for k, kind in enumerate(kinds)}
    run.answer(
        "last_period",
        "Over a waiting, strobe points closer than the noise merge: of Eq. (1)"
        f"{f', p{of_eq_1[0].m} to p{of_eq_1[-1].m} asked, ' if of_eq_1 else ' '}"
        + ", ".join(f"{f'from p{m} on' if m else 'none'} ({kind})" for kind, m in merged.items())
        + ". In one record of 40 strobes, and living where it is born, the last is "
        + ", ".join(f"{f'p{max(found)}' if found else 'none'} ({kind})" for kind, found in sharp.items())
        + (": a slow drift moves all points together." if len(kinds) > 1 else "."),
    )
    return merged
