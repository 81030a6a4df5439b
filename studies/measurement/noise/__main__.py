"""Hysteresis as an experiment with a noisy drive shows it.

Claims (letter 1996): "the measured hysteresis differs from the prediction"; the amplitude has a long-term
stability of 0.5 um of 2 mm, 2.5e-4.

The printed stability speaks of slow drift; white noise is an assumption.  Here both are standard deviations
of the amplitude, which is constant from strobe to strobe.  Correlation times, steps and waiting are options:
the letter prints 1e4 cycles with Fig. 5 alone, and no steps.

Computed: many scans of Eq. (1) along Fig. 3 (studies.measurement.noise.scans), and the same by formulas
(studies.measurement.noise.rates).  The observed hysteresis is the excess at which p_1 is left less that at
which p_m is lost.

Run:     python -m studies noise [--stability X] [--correlation-times S ...]
Writes:  escape.csv (a row an end of an orbit: quantiles of the excess, simulated and by formula),
         observed.csv (a row a frequency, period and noise), both also *_at_letter.csv, the scans and their
         seed (scans-*, where a run that was stopped goes on), and the figure observed
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from typing import Annotated

import numpy as np

from contact import StroboscopicMap
from contact.orbits import onset_orbit
from studies.letter import AMPLITUDE_STABILITY, SETTLE_CYCLES
from studies.measurement.noise.model import End, Observed, ends_of, observed_of
from studies.measurement.noise.places import Place
from studies.measurement.noise.scans import FEWEST, Protocol, cell
from studies.physics.drive_noise import DRIFTS, SMALL, TIMES
from studies.shell.digits import written
from studies.shell.files import fingerprint
from studies.shell.options import MOST_CELLS, Within
from studies.shell.scene import Scene, band_of, corresponding, harmonic, single_mode_at
from studies.shell.study import Run, study
from studies.shell.sweep import sweep

LOWEST_HZ, HIGHEST_HZ, BANDS = 19.6, 23.8, range(3, 11)
"""Of Fig. 3."""

SPACING = (0.1, 4), (0.5, 2)
"""Hz between places in a band, and places at least: the full form, the small one."""


@study(quick={"scans": 10, "correlation_times": (0.0, 100.0)})
def noise(
    scene: Scene,
    run: Run,
    *,
    stability: Annotated[float, "standard deviation over the amplitude", SMALL] = AMPLITUDE_STABILITY,
    correlation_times: Annotated[tuple[float, ...], "of its drift (s), 0 for white", TIMES] = DRIFTS,
    amplitude_step: Annotated[float, "of a scan, relative", SMALL] = AMPLITUDE_STABILITY,
    waiting: Annotated[int, "drive periods at each amplitude", Within(FEWEST, MOST_CELLS)] = SETTLE_CYCLES,
    scans: Annotated[int, "up and down at each frequency, for quantiles", Within(10, MOST_CELLS)] = 100,
    seed: Annotated[int, "of all noise"] = 1996,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    protocols = [
        Protocol(step=amplitude_step, waiting=waiting, stability=stability, correlation_s=time)
        for time in dict.fromkeys(correlation_times)
    ]
    letters = letter_periods(harmonic(scene))
    places = along_bands(scene, letters, *SPACING[run.quick])
    cells = [(place, each) for place in places for each in protocols]
    settings = {
        "seed": seed,
        "scans": scans,
        "protocols": [asdict(each) for each in protocols],
        "places": [[place.frequency_hz, place.m] for place in places],
    }
    own = fingerprint(run.scene.values(), settings)[:12]
    found = sweep(run, f"scans-{own}", settings, cells, partial(cell, scans, seed))
    made = [(*where, one) for where, one in zip(cells, found, strict=True)]
    ends = [row for rows in run.attempt(ends_of, made, "ends of orbits") for row in rows or ()]
    observed = [row for one in made if (row := observed_of(one)) is not None]
    off = [row.off**2 for row in ends if row.off is not None]
    if off:
        run.say(f"formulas are {np.sqrt(np.mean(off)):.2f} standard errors off (rms of {len(off)} medians)")
    at_letter = [row for row in ends if (row.frequency_hz, row.m) in letters]
    shown = [row for row in observed if (row.frequency_hz, row.m) in letters]
    run.table("escape", ends, "Excess at which p_m and p1 end, simulated and by formula.", of=End, show=())
    run.table("escape_at_letter", at_letter, "The same at the frequencies of the scene.", of=End)
    run.table("observed", observed, "Hysteresis as an observer would measure it.", of=Observed, show=())
    run.table("observed_at_letter", shown, "The same at the frequencies of the scene.", of=Observed)

    from studies.measurement.noise import figure  # matplotlib is slow to import

    if observed:
        run.figure("observed", figure.draw_observed(scene, observed, run.letters), figure.OBSERVED)
    return {"rows": observed, "ends": ends, **effect_of_noise(run, protocols, observed)}


def letter_periods(scene: Scene) -> list[tuple[float, int]]:
    """The frequencies of the scene at which a p_m of Eq. (1) is born, with m."""
    found = []
    for f in sorted(scene.drive.frequencies_hz):
        orbit = onset_orbit(StroboscopicMap(oscillator=single_mode_at(scene, f)), AMPLITUDE_STABILITY)
        found += [(f, orbit.m)] if orbit.m > 1 and orbit.impacts == 1 else []
    return found


def along_bands(
    scene: Scene, letters: Sequence[tuple[float, int]], spacing_hz: float, least: int
) -> list[Place]:
    """p_m of Eq. (1) along the bands of Fig. 3, and at the letter's frequencies."""
    found = set(letters)
    for m in BANDS:
        edges = band_of(scene, m)
        low = max(edges.lower, corresponding(scene, LOWEST_HZ))
        high = min(edges.upper, corresponding(scene, HIGHEST_HZ))
        count = max(least, int(np.ceil((high - low) / spacing_hz)))
        grid = high - (high - low) * (np.arange(count) + 0.5) / count
        found |= {(round(float(f), 4), m) for f in grid if high > low}
    return [Place(scene=scene, m=m, frequency_hz=f) for f, m in sorted(found)]


def effect_of_noise(
    run: Run, protocols: Sequence[Protocol], observed: Sequence[Observed]
) -> dict[str, object]:
    """The effect of the fastest drift, or of white noise without one, on the hysteresis of Eq. (1).

    Returns the median change, its part in the difference between observation and map, and the transitions
    at the frequencies of the scene whose hysteresis noise hides.
    """
    chosen = min(protocols, key=lambda each: each.correlation_s or np.inf)
    rows = [row for row in observed if row.noise == chosen.name]
    met = [row for row in rows if np.isfinite(row.median)]
    whole = [row for row in met if row.map is not None and row.fold > chosen.stability]
    if not whole:
        run.finding("In this noise of the amplitude no hysteresis can be compared with that of the map.")
        return {"hidden": []}
    shift = np.array([row.median - row.fold for row in whole])
    part = np.abs(shift) / (np.abs(shift) + np.abs([row.fold - (row.map or 0.0) for row in whole]))
    given = run.scene.drive.frequencies_hz
    missed = [row for row in met if not row.seen and row.frequency_hz in given]
    hidden = [f"p{row.m} at {row.frequency_hz:.2f} Hz" for row in missed]
    change, share = float(np.median(shift)), float(np.median(part))
    kind = "Slow drift" if chosen.correlation_s else "White noise"
    by = f"{'lowers' if change < 0.0 else 'raises'} the observed hysteresis by {written(abs(change), 2)}"
    run.finding(f"{kind} of the amplitude {by}.")
    between = "of the difference between observation and map; the truncation of the map makes the rest"
    run.finding(f"Noise makes {100.0 * share:.0f} % {between}.")
    if hidden:
        names = " and ".join(dict.fromkeys(each.split()[0] for each in hidden))
        run.finding(f"Noise of this size hides the hysteresis of {names}.")
    return {"hidden": hidden, "change": change, "share": share}
