"""The highest period that begins at grazing, and what errors can change.

Claims (letter 1996): T = 40.80 +- 0.02 ms; the last of the six transitions, at 23.40 Hz, goes to p10; p10 "is
at the limit of our experimental resolution and stability".  Map, Eq. (1) and beam have p11 there.

Computed:

    sensitivity   born period at excess 1e-3 and fold F_m/F_g - 1 in map, Eq. (1) and beam after each change
    p10           excesses with p10, and with all six periods, for each cause that can turn p11 into p10
    pairs         free periods T at which the six printed pairs (f, m) are born, in the map and in Eq. (1)
    clouds        p_m in noise of the amplitude: distance of its strobe points over their width

The printed stability speaks of slow drift; white noise is an assumption.  Both are standard deviations of the
amplitude, which is constant from strobe to strobe.  The pairs belong to the letter's spring and are left out
for another one.

Run:     python -m studies last_period [--stability X] [--correlation-times S ...]
Writes:  sensitivity.csv (a row a frequency, description and change), p10.csv (a row a cause), pairs.csv,
         clouds.csv (a row a period), and the figure fold_against_parameter
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated

from studies.experiment.last_period import changes, pairs
from studies.experiment.last_period.causes import Effect, causes_of, effect_of
from studies.experiment.last_period.changes import DESCRIPTIONS, changes_of, transitions_after, transitions_at
from studies.experiment.last_period.clouds import Clouds, clouds_of, frequency_of, key_of
from studies.letter import AMPLITUDE_STABILITY, TRANSITION_HZ
from studies.physics.descriptions import strobed_at
from studies.physics.drive_noise import DRIFTS, SMALL, TIMES, DriveNoise
from studies.shell.digits import written
from studies.shell.scene import Scene, harmonic, model_of, single_mode_at, spring_of
from studies.shell.study import Run, study

HIGHEST = max(TRANSITION_HZ)  # m of the last transition that the letter saw

IN_NOISE = range(3, 17), range(8, 12)  # m of Eq. (1) in noise: the full form, the small one


@study(needs={"fold": 0.05}, quick={"correlation_times": (0.0, 100.0)})
def last_period(
    scene: Scene,
    run: Run,
    *,
    stability: Annotated[float, "standard deviation over the amplitude", SMALL] = AMPLITUDE_STABILITY,
    correlation_times: Annotated[tuple[float, ...], "of its drift (s), 0 for white", TIMES] = DRIFTS,
) -> Mapping[str, object]:
    """Compute, store and draw."""
    spring_of(harmonic(scene))  # refuses measured modes: dimensions are varied
    times = dict.fromkeys(correlation_times)
    noises = [DriveNoise(stability=stability, correlation_s=time) for time in times]
    model, frequencies = model_of(scene), sorted(scene.drive.frequencies_hz)

    before = run.map(partial(transitions_at, scene, model), frequencies, "frequencies")
    base = [row for rows in before for row in rows]
    after = run.attempt(partial(transitions_after, scene, base), changes_of(scene, run.quick), "changes")
    rows = base + [row for found in after for row in found or ()]
    run.table(
        "sensitivity", rows, "Period born at grazing, and fold, after each change.", of=changes.Transition
    )
    from studies.experiment.last_period import figure  # matplotlib is slow to import

    run.figure("fold_against_parameter", figure.draw_tornado(rows), figure.TORNADO)

    causes = causes_of(scene, model)[: 20 if run.quick else None]
    effects = run.map(partial(effect_of, scene, 1.5 if run.quick else 1.05), causes, "causes of p10")
    run.table("p10", effects, "The periods that begin with each cause at six drive frequencies.", of=Effect)
    intervals = pair_intervals(scene, run)

    letters = [(row.frequency_hz, row.m) for row in base if row.description == "Eq. (1)" and row.m > 1]
    places = [("single_mode", frequency_of(scene, m), m) for m in IN_NOISE[run.quick]]
    places += [("beam", f, m) for f, m in letters[-2 if run.quick else 0 :]]
    noisy = [(DESCRIPTIONS[name], strobed_at(name, scene, f, model), m) for name, f, m in places]
    found = run.attempt(partial(clouds_of, noises), noisy, "periods in noise")
    clouds = [row for row in found if row]
    caption = "The clouds of strobe points of p_m in noise of the drive, at an excess of 0.001."
    run.table("clouds", clouds, caption, of=Clouds)
    merged = judge(run, noises, effects, clouds)
    return {
        "rows": rows,
        "p10": effects,
        "pairs": intervals,
        "clouds": clouds,
        "first_merged": merged,
        "free_period_for_it_at_grazing_s": 2.0 * HIGHEST / ((2.0 * HIGHEST + 1.0) * frequencies[-1]),
    }


def pair_intervals(scene: Scene, run: Run) -> list[pairs.Interval]:
    """The free periods at which the letter's pairs are born."""
    if not run.letters:
        return []
    intervals_of = partial(pairs.intervals_of, single_mode_at(scene, TRANSITION_HZ[5]))
    columns = run.map(intervals_of, pairs.EXCESSES[: 2 if run.quick else None], "excesses of the pairs")
    rows = [row for column in columns for row in column]
    run.table("pairs", rows, "Free periods with the letter's six pairs.", of=pairs.Interval, show=())
    off = next(row.missed_by_s for row in rows if row.pairs == "all" and row.excess == 0.0)
    if off:
        size, way = f"{1e3 * abs(off):.2f} ms", "shorter" if off > 0.0 else "longer"
        run.finding(
            f"In the map the six periods of the letter need a free period {size} {way} than its error allows."
        )
    return rows


def judge(
    run: Run, noises: Sequence[DriveNoise], effects: Sequence[Effect], clouds: Sequence[Clouds]
) -> dict[str, int | None]:
    """Verdict and findings on the last period; first m of Eq. (1) whose clouds merge in each noise."""
    of_eq_1 = [(row.m, row.apart) for row in clouds if row.description == "Eq. (1)" and row.apart]
    merged = {
        noise.name: next((m for m, apart in of_eq_1 if not apart[key_of(noise)] >= 1.0), None)
        for noise in noises
    }
    kind, first = next(iter(merged.items()))
    run.verdict(
        "last_period",
        "agrees" if first is not None and 0 <= first - HIGHEST <= 1 else "in part",
        found=", ".join(f"{f'p{m}' if m else 'none'} ({name})" for name, m in merged.items()),
        note="first period whose closest strobe points merge in noise of the amplitude's stability",
    )
    noisy = f"In {f'a {kind}' if noises[0].correlation_s else 'white noise'} of the drive amplitude"
    if first is None:
        apart = "stay apart for every period" if of_eq_1 else "show no period"
        run.finding(f"{noisy} the strobe points of Eq. (1) {apart} that was tried.")
    else:
        last = ", the last that the letter saw" if run.letters and first == HIGHEST else ""
        run.finding(f"{noisy} the strobe points of Eq. (1) merge from p{first} on{last}.")
    if run.letters:
        plain = effects[1].six_from
        when = f"only from an excess of {written(plain, 2)} on" if plain else "at no excess"
        run.finding(f"Eq. (1) has all six periods of the letter {when}.")
    return merged
