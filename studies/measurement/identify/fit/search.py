"""Least squares: from a record to the best fit of many starts.

    r_i = (observed_i - predicted_i(p))/sigma_i,   chi^2 = sum r_i^2  ->  least.

All starts are refined on a part of the rows, the best that differ on all rows; the best of these is kept.
Where a profile of the likelihood finds a better fit, the search goes on from there.  A displacement is
tried as an orbit; one without impacts as a linear motion; one that does not repeat from its first row on.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from beam import InvalidValue, Refusal
from contact import ContactError, ImpactOscillator
from studies import letter
from studies.measurement.identify.fit.descent import Found
from studies.measurement.identify.fit.diagnosis import added, wanders
from studies.measurement.identify.fit.problem import Problem, chance_of
from studies.measurement.identify.fit.profiles import Conditional
from studies.measurement.identify.fit.result import TOO_SMALL, Fit, determined, judged
from studies.measurement.identify.motion.linear import Linear
from studies.measurement.identify.motion.predictions import Prediction
from studies.measurement.identify.motion.starts import predictions_of
from studies.measurement.identify.motion.unsteady import unsteady_starts
from studies.measurement.identify.record.records import READ_OUT, Array, NoAnswer, Record, Undetermined
from studies.measurement.identify.record.soundness import sound
from studies.measurement.identify.record.spectrum import repetition
from studies.physics.parameters import parameters_of, require_names, with_values
from studies.shell.digits import in_unit

LEASH = 1.0  # prior of the parameters while few rows are fitted, which need not determine all of them
EARLY, ROUGH = 40, 1e-3  # most steps from each start, until chi^2 falls by no more than this part
FINISHED = 3  # starts that are fitted to the end; more if none is like the record
SAME = 3e-3  # relative difference of values that are the same
ASTRAY = 9.0  # growth of chi^2 by row at which the fit of more and more rows is given up
SHORT = 20.0  # drive periods of a motion that are fitted where more are not: chaos forgets its start
LOUD = 0.3  # noise over the scatter of a record that hides all impacts
LOST = 30.0  # error of a parameter over its value at which no profile shows more
TONE = 0.7  # part of what does not repeat that a hum must have to be the reason why there is no fit
AGAIN, BETTER = 4, 0.2  # fits begun at a better point of a profile; by how much chi^2 is less there


def fit(
    record: Record,
    oscillator: ImpactOscillator,
    names: Sequence[str],
    *,
    noise: float | None = None,
    free: Sequence[str] = ("phase", "offset"),
) -> Fit:
    """Fit the named parameters; the others keep the values of `oscillator`, driven as the record was.

    `noise` is the standard deviation of the read-out where it is known [m], or of the excesses of a table;
    `free` are the numbers of the sensor that are fitted to a displacement.  NoAnswer is raised, in one
    sentence, for a record that cannot determine them.
    """
    require_names(names, oscillator)
    known = noise is not None or len(record.columns) == 4
    unit = noise or (letter.AMPLITUDE_STABILITY if record.kind == "transitions" else READ_OUT)
    if record.kind == "motion":
        if noise is not None and noise > LOUD * (size := float(record.observed.std())):
            given, seen = (in_unit(one, record.unit, 3) for one in (noise, size))
            raise InvalidValue(f"noise is {given}; it must be well below the scatter of the record, {seen}")
        return _motion(*sound(record, oscillator), tuple(names), free, unit, known)
    starts = predictions_of(record, oscillator, tuple(names), free)
    return _solved(starts, tuple(names), oscillator, unit, known)


def _solved(
    starts: Sequence[tuple[Prediction, ImpactOscillator]],
    names: tuple[str, ...],
    oscillator: ImpactOscillator,
    unit: float,
    known: bool,
) -> Fit:
    """The best fit from these starts; it begins again where a profile finds a better one."""
    problem, found = best([Problem(one, at, names, unit) for one, at in starts], known)
    with suppress(ContactError, Refusal):  # what has been found stays
        for _ in range(AGAIN):
            if (clear := problem.prediction.cleared(*problem.at(found.x))) is None:
                break
            other = Problem(clear, problem.oscillator, names, unit)
            problem, found = other, other.solve(found.x)
    for _ in range(AGAIN):
        result = judged(problem, found, oscillator, known)
        walks, lowest = _walked(result)
        if lowest is None:
            break
        found = problem.solve(problem.unknowns_of(lowest.values))
    return determined(replace(result, walks=walks))


def _motion(
    record: Record,
    oscillator: ImpactOscillator,
    names: tuple[str, ...],
    free: Sequence[str],
    unit: float,
    known: bool,
) -> Fit:
    """The best fit of a displacement: of a linear motion, of one that repeats, or of one that does not."""
    given = names, oscillator, unit, known
    linear, failure, starts = Linear(record), None, list[tuple[Prediction, ImpactOscillator]]()
    found: Fit | None = None
    try:
        starts += [] if linear.likely else predictions_of(record, oscillator, names, free)
        if starts:
            found = _solved(starts, *given)
        else:  # a linear motion, its stop far away while it is fitted
            prediction, begun, own = linear.start(oscillator, names, free)
            best = _solved([(prediction, begun)], own, *given[1:])
            linear.require_decay(parameters_of(best.oscillator)["decay_rate"].value)
            found = replace(best, oscillator=with_values(best.oscillator, {"gap": oscillator.stop.gap}))
        if not found.too_small:
            return found
    except NoAnswer as error:
        if starts and isinstance(error, Undetermined):
            raise
        failure = error
    times, x = (found.record if found else record).rows.T
    residuals = found.residuals[:, 0] if found else x - x.mean()
    words = wanders(times, x, residuals, float(linear.frequency))
    early = int(np.searchsorted(times, times[0] + SHORT / float(linear.frequency)))
    for size in dict.fromkeys([len(x), early] if words else []):
        linear.record = replace(record, rows=record.rows[:size])
        with suppress(NoAnswer):
            other = _solved(unsteady_starts(linear, oscillator, names, free), *given)
            if not other.too_small:
                rows = "" if size == len(x) else f" by the first {size} rows"
                note = f"{words[0]}: the fit is one of a transient or a chaotic motion{rows}"
                return replace(other, record=replace(other.record, notes=(*record.notes, note)))
    if found is None:
        base = linear.frequency / repetition(times, x, linear.frequency)
        hum = added(times, x, base, TONE, record.order) if 2.0 < base * (times[-1] - times[0]) else []
        reasons = [*hum, str(failure or "no motion like the record's was found")]
        raise NoAnswer("; ".join(reasons))
    return found


def _walked(found: Fit) -> tuple[dict[str, tuple[float, float]], Conditional | None]:
    """Intervals by profiles where chi^2 is no parabola, and a point that is better than the fit, if there is
    one."""
    walks = dict[str, tuple[float, float]]()
    for i, name in enumerate(found.problem.names if found.settled and not found.too_small else ()):
        if not found.errors[i] < LOST * abs(found.estimate[i]):
            continue
        walk = found.walk(name)
        if walk.bent(found.reach):
            sides = [walk.side(way * found.reach) for way in (-1.0, 1.0)]
            lowest = min([*sides[0][0], *sides[1][0], walk.best], key=lambda point: point.rise)
            if lowest.rise < -BETTER:
                return walks, lowest
            walks[name] = sides[0][1], sides[1][1]
    return walks, None


def best(problems: Sequence[Problem], known: bool) -> tuple[Problem, Found]:
    """The problem that is solved best, and its solution: all are begun, the best that differ are finished."""
    if not problems:
        raise NoAnswer("no motion like the record's was found to start from")
    rows, count = problems[0].observed.size, problems[0].unknowns
    if rows < count + (not known):
        raise NoAnswer(f"the record has {rows} numbers, too short for {count} unknowns and their errors")
    failure, begun = None, list[tuple[float, int, Array]]()
    for i, problem in enumerate(problems):
        first = _part(problem, 0)
        try:
            found = first.solve(problem.start, EARLY, ROUGH * first.freedom)
            whole = problem if problem.prediction.m else first
            begun.append((float(np.sum(whole.residuals(found.x) ** 2)), i, found.x))
        except (ContactError, Refusal) as error:
            failure = failure or error
    ends, tried, enough = list[tuple[Problem, Found]](), list[Array](), False
    for cost, i, unknowns in sorted(begun, key=lambda one: one[:2]):
        problem, values = problems[i], problems[i].values(unknowns)[problems[i].named]
        alike = any(np.allclose(values, other, rtol=SAME, atol=0.0) for other in tried)
        if alike or (enough and len(ends) >= FINISHED):
            continue
        tried.append(values)
        try:
            sizes = [len(part.record.rows) for part in problem.prediction.parts()]
            for k, size in enumerate(sizes[1:-1], 1):
                found = _part(problem, k).solve(unknowns)
                if found.chi2 * sizes[0] > ASTRAY * cost * size:
                    raise NoAnswer(f"the motion that is like the first {sizes[0]} rows is unlike later ones")
                unknowns = found.x
            found = problem.solve(unknowns)
            chance = chance_of(problem, found, known)
            enough = enough or chance > TOO_SMALL
            ends.append((problem, found))
        except (ContactError, Refusal) as error:
            failure = failure or error
    if not ends:
        if isinstance(failure, NoAnswer):
            raise failure
        raise NoAnswer(f"no motion like the record's was found to start from: {failure}")
    return min(ends, key=lambda end: end[1].chi2)


def _part(problem: Problem, number: int) -> Problem:
    """The problem of a part of its prediction."""
    parts = problem.prediction.parts()
    if len(parts) == 1:
        return problem
    return Problem(parts[number], problem.oscillator, problem.names, problem.noise, LEASH)
