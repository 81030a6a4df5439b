"""Start values of a fit, of a settled motion.

Strobe points: they repeat after m rows.  The start is the orbit p_m of the given oscillator at the record's
drive.  If there is none, or none like the record, parameters and approach speed are fitted together until an
orbit is close.  The drive amplitude may then be a little off.

A motion: the kicked motion that is most like it (``record.kicks``) gives free period, decay rate,
amplitude, phase, gap, restitution, the offset and the sign of the sensor, and the state at the first row.  It
does not show the stiffness or the delay of a contact, of which several values are tried.
"""

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from scipy.optimize import least_squares

from beam import Refusal
from contact import ContactError, ImpactOscillator, SingleImpactOrbit, State, simulate
from contact.orbits import Shooting
from studies.measurement.identify.motion.predictions import Prediction, Transitions, family_of
from studies.measurement.identify.motion.readings import SENSOR, Readings
from studies.measurement.identify.record.channel import clear_of
from studies.measurement.identify.record.kicks import Kicked, kicked_motions
from studies.measurement.identify.record.records import Array, NoAnswer, Record
from studies.measurement.identify.record.soundness import require_strobe_units, require_units
from studies.physics.parameters import parameters_of, with_values

LONGEST = 64  # period of an orbit that is looked for [drive periods]
ALIKE = 3.0  # a record repeats after m rows if their difference is below this times the least one
FLAT = 1e-3  # scatter over size of strobe points that are one and the same
CLOSE = 0.01  # part of the record's size below which residuals of a start need no search
SIMILAR = 0.1  # the same above which a search has failed
SPEEDS = np.geomspace(0.01, 0.5, 12)  # approach speeds of first orbits, in units of 2 pi f gap
SEEN = 40.0  # fall of chi^2 by kicks: noise alone gives 25 once in a thousand records
TRIED, WORSE = 6, 30.0  # kicked motions that are tried; ratio of chi^2 to the best one's at most
FACTORS = (0.1, 10.0, 0.3, 3.0, 0.03, 30.0)  # on numbers of a contact that no kick shows
RESTITUTIONS = (0.1, 0.3, 0.6, 0.9)  # tried beside the ones of the record and the scene
ASIDE = (0.97, 0.99, 0.997, 0.999, 1.001, 1.003, 1.01, 1.03)  # on gap or amplitude where no orbit closes
WIDE = 0.01  # drive periods about a kick in which velocities and accelerations are left out at first
LOOKED = 200  # times of an orbit at which the tip may be farthest from the stop, where its state begins


def predictions_of(
    record: Record,
    oscillator: ImpactOscillator,
    names: Sequence[str],
    free: Sequence[str] = ("phase", "offset"),
) -> Sequence[tuple[Prediction, ImpactOscillator]]:
    """Predictions of the rows and the starts of their fits, the best first; NoAnswer for a poor record.

    `free` are the numbers of the sensor that are fitted to a displacement.  One without impacts has no start.
    """
    if record.kind == "transitions":
        return [(Transitions(record), oscillator)]
    if record.kind == "strobe":
        require_strobe_units(record, oscillator)
        return [_strobes(record, oscillator, names)]
    return _motion(record, oscillator, names, free)


def strobe_period(record: Record) -> int:
    """The period of strobe points in drive periods; NoAnswer if they do not repeat or have no impact."""
    rows = record.observed[:, 0]
    most = min(LONGEST, len(rows) // 2)
    off = np.array([np.sqrt(np.mean((rows[m:] - rows[:-m]) ** 2)) for m in range(1, most + 1)])
    period = int(np.argmax(off <= ALIKE * off.min())) + 1
    if rows.std() < FLAT * np.abs(rows).max():
        raise NoAnswer("the strobe points stay where they are: there is no impact in the record")
    if off[period - 1] > SIMILAR * rows.std():
        why = "the record is too short, or its strobe points do not repeat"
        raise NoAnswer(f"{why}: no period up to {most} rows")
    if period == 1:
        raise NoAnswer("the strobe points repeat after one drive period: no sign of an impact")
    return period


def _strobes(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str]
) -> tuple[Readings, ImpactOscillator]:
    period, size = strobe_period(record), float(record.observed[:, 0].std())
    if (count := period * record.observed.shape[1]) < len(names):
        raise NoAnswer(f"p{period} gives {count} numbers, too few for {len(names)} parameters")

    def near(at: ImpactOscillator, most: float) -> Readings | None:
        """The orbit at the drive of this oscillator, if it is off by less than this part of the record."""
        try:
            orbits = family_of(at, period).orbits(at.excess)
            if not orbits:
                return None
            start = strobes_of(orbits[-1], record)[1]
            found = Readings(record, at, start, SENSOR, (), m=period)
            off = (found.values(at, found.extra) - record.observed)[:, 0]
        except (ContactError, Refusal):
            return None
        return found if np.sqrt(np.mean(off**2)) < most * size else None

    found, begun = near(oscillator, CLOSE), oscillator
    if found is None:
        begun, orbit = _searched(record, oscillator, names, period)
        begun = orbit.oscillator if "amplitude" in names else begun
        found = near(begun, SIMILAR)
    if found is None:
        advice = "give better values of what is not fitted, or fit more"
        raise NoAnswer(f"no p{period} with one impact was found near the record: {advice}")
    return found, begun


def strobes_of(orbit: SingleImpactOrbit, record: Record) -> tuple[Array, Array]:
    """The rows of the record by an orbit, in the cyclic order that fits best, and its state at the first."""
    oscillator, m, rows = orbit.oscillator, orbit.m, record.observed
    exact = Shooting(oscillator=oscillator, m=m).at_speed(orbit.speed)
    run = simulate(oscillator, exact.state(), periods=m)
    states = run.strobe_displacement, run.strobe_velocity
    points = np.column_stack([oscillator.tip(one) for one in states[: rows.shape[1]]])
    mean = np.array([rows[k::m, 0].mean() for k in range(m)])
    places = (np.arange(m) - np.arange(m)[:, None]) % m
    best = places[np.argmin(np.sum((points[places, 0] - mean) ** 2, axis=1))]
    return points[best[np.arange(len(rows)) % m]], np.append(*(one[best[0]] for one in states))


def _searched(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str], m: int
) -> tuple[ImpactOscillator, SingleImpactOrbit]:
    """The oscillator and orbit p_m most like the record, its amplitude allowed to be a little off."""
    known, unit, kept = parameters_of(oscillator), oscillator.unit_speed, "amplitude" not in names
    own = [name for name in names if name != "amplitude"]
    sizes, scale = np.array([known[name].size for name in own]), record.units(CLOSE * oscillator.stop.gap)

    def orbit_at(unknowns: Array) -> tuple[ImpactOscillator, SingleImpactOrbit]:
        at = with_values(oscillator, dict(zip(own, (unknowns[:-1] * sizes).tolist(), strict=True)))
        return at, family_of(at, m).orbit(math.exp(unknowns[-1]) * unit)

    def off(unknowns: Array) -> Array:
        try:
            at, orbit = orbit_at(unknowns)
            rows = ((strobes_of(orbit, record)[0] - record.observed) / scale).ravel()
        except (ContactError, Refusal):
            return np.full(scale.size + 1, np.nan)
        drive = orbit.amplitude / at.driven.amplitude - 1.0
        return np.append(rows, kept * drive * math.sqrt(rows.size) / CLOSE)

    begun = np.array([known[name].value for name in own]) / sizes
    starts = [np.append(begun, math.log(part)) for part in SPEEDS]
    costs = np.array([np.sum(off(start) ** 2) for start in starts])
    best = [starts[i] for i in np.argsort(costs)[:3] if np.isfinite(costs[i])]
    if not best:
        raise NoAnswer(f"the scene has no p{m} with one impact at {oscillator.driven.frequency:g} Hz")
    found = [least_squares(off, start, max_nfev=30, x_scale="jac") for start in best]
    return orbit_at(min(found, key=lambda one: one.cost).x)


def _motion(
    record: Record, oscillator: ImpactOscillator, names: Sequence[str], free: Sequence[str]
) -> Sequence[tuple[Prediction, ImpactOscillator]]:
    motions = kicked_motions(record, oscillator)
    if motions[0].without - motions[0].cost < SEEN:
        return []
    likely = [one for one in motions if one.reading()["gap"] > 0.0 and one.base != 0.0]
    if not likely:
        raise NoAnswer("the record repeats, but not as a motion with impacts at one gap")
    lengths = {"gap": likely[0].reading()["gap"], "amplitude": abs(likely[0].base)}
    period = {"free_period": parameters_of(likely[0].oscillator)["free_period"].value}
    require_units(record, oscillator, period if "scale" in free else lengths | period)
    likely = [one for one in likely if one.cost < WORSE * likely[0].cost + SEEN][:TRIED]
    starts = [starts_at(record, motion, oscillator, names, free, i > 0) for i, motion in enumerate(likely)]
    return [one for each in starts for one in each]


def starts_at(
    record: Record,
    motion: Kicked,
    oscillator: ImpactOscillator,
    names: Sequence[str],
    free: Sequence[str],
    few: bool,
) -> list[tuple[Readings, ImpactOscillator]]:
    """Starts at a kicked motion, with several values of what it does not show of the contact, or `few`;
    and at the given values."""
    at, read = motion.oscillator, motion.reading()
    sign, read["restitution"] = read["sign"], min(max(read["restitution"], 0.01), 0.99)
    known = parameters_of(oscillator)
    drive = complex(1j * motion.base * sign)
    held = [name for name in ("gap", "amplitude") if name not in names and "scale" in free]
    size = ({"gap": read["gap"], "amplitude": abs(drive)}[held[0]] / known[held[0]].value) if held else 1.0
    read |= {"gap": read["gap"] / size, "amplitude": abs(drive / size)}
    shown = {name: one.value for name, one in parameters_of(at).items()} | read
    soft = [name for name in ("stiffness", "delay") if name in names]
    sensor = {"offset": motion.offset, "phase": float(np.angle(drive)), "scale": sign * size}
    sensor = {name: sensor[name] if name in (*free, "scale") else one for name, one in SENSOR.items()}
    lasting = motion.m * at.period
    clock = np.linspace(0.0, lasting, LOOKED, endpoint=False)
    away = sensor["phase"] / at.driven.angular_frequency
    heights = [sign * motion.tip(t - away)[0] for t in clock]
    lowest = float(clock[int(np.argmin(heights))])
    start = sign / size * np.add(*motion.state(lowest - away))
    law = {name: known[name].value for name in ("restitution", *soft) if name in names}
    own = {name for name in names if name in known and name not in soft}
    begun = with_values(oscillator, {name: value for name, value in shown.items() if name in own})
    others: list[dict[str, float]] = [{}, law]
    if soft:
        others = [law, *({soft[0]: law[soft[0]] * factor} for factor in FACTORS[: 2 if few else None])]
    elif few:
        others = [{}]
    elif "restitution" in law:
        others += [{"restitution": part} for part in RESTITUTIONS]
    tried = [with_values(begun, other) for other in others]
    given = [with_values(oscillator, {"frequency": begun.driven.frequency})]
    given = [] if few or not oscillator.driven.amplitude else given
    moved = next((name for name in ("gap", "amplitude") if name in names), None)
    clear = clear_of(record, motion.kicks, motion.kicks, lasting, WIDE * at.period)
    pairs = list[tuple[Readings, ImpactOscillator]]()
    for one in [*(_behind(one, start, lowest, lasting) for one in tried), *given]:
        prediction = Readings(clear, one, start, sensor, free, whole=record, m=motion.m, clock=lowest)
        closed = _closing(prediction, one, moved)
        with suppress(ContactError, Refusal):
            prediction = prediction.cleared(closed, prediction.extra, WIDE * at.period) or prediction
        pairs.append((prediction, closed))
    return pairs


def _closing(prediction: Readings, oscillator: ImpactOscillator, name: str | None) -> ImpactOscillator:
    """The oscillator; where no orbit closes, with the value of this name near by that fits best."""
    part, found = prediction.parts()[0], list[tuple[float, float]]()
    value = parameters_of(oscillator)[name or "gap"].value
    for factor in (1.0, *(ASIDE if name else ())):
        with suppress(ContactError, Refusal):
            at = with_values(oscillator, {name or "gap": factor * value})
            off = part.again().values(at, part.extra) - part.record.observed
            if factor == 1.0:
                return oscillator
            found.append((float(np.sum(off**2)), factor))
    return with_values(oscillator, {name: min(found)[1] * value}) if name and found else oscillator


def _behind(oscillator: ImpactOscillator, start: Array, clock: float, lasting: float) -> ImpactOscillator:
    """The oscillator with the gap at which a kick in the middle of a contact is this contact.

    A kicked tip goes on at its approach velocity v until the middle of a contact of duration d: to v d/2
    beyond the stop.
    """
    state = State(displacement=start[0], velocity=start[1], time=clock)
    try:
        impacts = simulate(oscillator, state, duration=lasting).impacts
        if not len(impacts):
            return oscillator
        first = int(np.argmax(impacts.approach))
        beyond = 0.5 * float(impacts.approach[first] * (impacts.end[first] - impacts.start[first]))
        return with_values(oscillator, {"gap": oscillator.stop.gap - beyond})
    except (ContactError, Refusal):
        return oscillator
