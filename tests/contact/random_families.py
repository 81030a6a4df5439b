"""Random families of periodic orbits; `orbit_judge` judges what the package finds on them.

    python tests/contact/random_families.py --families 300 --seed 1

prints every answer that is wrong, and how many answers and refusals there were; with --quick without paths.
With --steps it compares the events of `follow` at its default step and at one four times shorter.
"""

import argparse
import contextlib
import math
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
from orbit_judge import PLACE, Curve, wrong_event, wrong_orbit
from oscillators import ARRAYS, modes_on_stop

import contact
from beam import ModalChange
from contact import ContactError, DelayedRestitution, ImpactOscillator, orbits
from contact.orbits import Change, Event, PeriodicOrbit, Shooting

GAP = 0.01  # m


FIVE = ("newton", "linear", "hertz", "hunt-crossley", "delayed")


def random_oscillator(rng: np.random.Generator, laws: Collection[str] = FIVE) -> ImpactOscillator:
    """One to six modes under one of the laws; under `DelayedRestitution` one."""
    name, unit = rng.choice([*laws]), 150.0
    n = 1 if name == "delayed" else int(rng.integers(1, 7))
    omega = unit * np.append(1.0, np.sort(rng.uniform(1.2, 30.0, n - 1)))
    decay = 2.0 * 10.0 ** rng.uniform(-2.7, -0.8, n) * omega
    phi, gamma = (np.append(1.0, rng.uniform(-most, most, n - 1)) for most in (1.0, 0.5))
    w = unit * rng.uniform(0.35, 0.99 if n == 1 else min(1.7, 0.99 * omega[-1] / unit))
    mobility, e = float(phi @ phi), rng.uniform(0.05, 0.9)
    stiffness = (unit * 10.0 ** rng.uniform(0.5, 2.0)) ** 2 / mobility
    hertz, chi = stiffness / math.sqrt(0.1 * GAP), 10.0 ** rng.uniform(-2.0, 0.3) / (w * GAP)
    dashpot = 0.5 * e * math.sqrt(stiffness / mobility)
    law: contact.ContactLaw = {
        "newton": contact.NewtonRestitution(local_restitution=e),
        "linear": contact.LinearContact(stiffness=stiffness, damping=dashpot),
        "hertz": contact.HertzContact(stiffness=hertz),
        "hunt-crossley": contact.HuntCrossley(stiffness=hertz, dissipation=chi),
        "delayed": DelayedRestitution(restitution=e, delay=10.0 ** rng.uniform(-3.0, -0.5) / w),
        "power": contact.PowerContact(stiffness=stiffness / GAP**0.25, exponent=1.25, damping=dashpot),
    }[name]
    return modes_on_stop(omega, decay, phi, gamma, law=law, gap=GAP, drive=w / (2.0 * np.pi))


def random_family(rng: np.random.Generator, laws: Collection[str] = FIVE) -> tuple[Shooting, PeriodicOrbit]:
    """A settled motion of one to four touches, mostly several, in one to five drive periods."""
    fewest = int(rng.random() < 0.9) + 1
    while True:
        oscillator = random_oscillator(rng, laws).with_excess(10.0 ** rng.uniform(-2.5, 0.6))
        strobed = contact.StroboscopicMap(oscillator=oscillator)
        start = strobed.at(-1e-3).steady() if rng.random() < 0.5 else contact.State.rest(oscillator.n_modes)
        try:
            found = orbits.settle(strobed, start, most_cycles=512, largest_m=16)
            if not (1 <= found.m <= 5 and fewest <= found.impacts <= 4):
                continue
            family = Shooting(oscillator=oscillator, m=found.m, impacts=found.impacts)
            return family, family.from_state(replace(found.end, time=0.0))
        except ContactError:
            continue


def random_change(oscillator: ImpactOscillator, rng: np.random.Generator) -> Change:
    model, law = oscillator.model, oscillator.stop.law
    arrays = {name: rng.normal(size=model.n_modes) * getattr(model, name) for name in ARRAYS}
    return Change(
        model=ModalChange(**arrays),
        gap=oscillator.stop.gap * rng.normal(),
        law=tuple((*law.adjustable, 0.0)[:2] * rng.normal(size=2)),
        frequency=oscillator.driven.frequency * rng.normal(),
        amplitude=oscillator.driven.amplitude * rng.normal(),
    )


def judged(
    family: Shooting, start: PeriodicOrbit, change: Change, names: Collection[str]
) -> Iterator[tuple[str, str]]:
    """Kinds of answers of the calls `names`, and what is wrong with each: nothing where it is right; a
    refusal that says why is right too."""
    by_excess, by_change = family.oscillator.with_excess, partial(change.applied, start.oscillator)
    low, at, high, speed = 0.9 * start.excess - 0.1, start.excess, start.excess + 0.1, start.speed
    calls: dict[str, Callable] = {
        "fold_of": lambda: [orbits.fold_of(family, start)],
        "first_event": lambda: [orbits.first_event(family, start, -0.9)],
        "follow": lambda: orbits.follow(family, start, low=0.6 * speed, high=1.8 * speed),
        "path in amplitude": lambda: orbits.follow_path(by_excess, start, at, low=low, high=high),
        "path": lambda: orbits.follow_path(by_change, start, 0.0, low=-0.01, high=0.01),
    }
    for name in names:
        if name == "steps":
            yield name, wrong_steps(family, start)
            continue
        try:
            answer = calls[name]()
        except ContactError as error:
            yield f"{name} refuses", "" if len(str(error)) > 30 else f"gives no reason: {error}"
            continue
        path, unit = (by_change, 2e-3) if name == "path" else (by_excess, 2e-2)
        found = () if isinstance(answer, list) else answer.orbits
        events = [
            Event(kind="fold", orbit=event) if isinstance(event, PeriodicOrbit) else event
            for event in (answer.events if found else answer)
        ]
        for event in filter(None, events):
            p = event.parameter if name == "path" else event.orbit.excess
            with contextlib.suppress(contact.UnresolvedCrossing):  # what cannot be simulated is not judged
                wrong = wrong_orbit(event.orbit) or wrong_event(event, path, p, unit)
                yield f"{name}: {event.kind}", f"at {p:.9g} {wrong}" if wrong else ""
        places = answer.parameters if name == "path" else [orbit.excess for orbit in found]
        for (a, p), (b, q) in [*pairwise(zip(found, places, strict=True))][:: 1 + len(found) // 60]:
            fast = max(a.approach.max(), a.oscillator.unit_speed)
            slow = min(a.approach.min(), b.approach.min()) < math.sqrt(PLACE) * fast
            if a.impacts == b.impacts and not slow:  # next to a graze the judge's differences fail
                same = Curve(path, a, unit).joins(a, p, b, q)
                yield f"{name}: neighbours", "" if same else f"at {p:.9g} and {q:.9g} lie on two curves"
        for orbit in found[:: 1 + len(found) // 10]:
            with contextlib.suppress(contact.UnresolvedCrossing):
                yield f"{name}: orbit", wrong_orbit(orbit)


def events_by_step(family: Shooting, start: PeriodicOrbit, step: float) -> tuple[list[str], list[float]]:
    """Kinds of the events of a branch and why it ends, and their excess, at steps of this length."""
    branch = orbits.follow(family, start, low=0.2 * start.speed, high=5.0 * start.speed, step=step)
    told = [event for event in branch.events if event.kind != "undecided"]  # next to a graze
    ends = [end if end in ("range", "closed") else "lost" for end in (branch.ended_low, branch.ended_high)]
    return [*(event.kind for event in told), *ends], [event.orbit.excess for event in told]


def wrong_steps(family: Shooting, start: PeriodicOrbit) -> str:
    """What `follow` finds otherwise at its default step than at one four times shorter; "" if nothing."""
    (kinds, found), (other, finer) = (events_by_step(family, start, step) for step in (0.1, 0.025))
    same = kinds == other and np.allclose(found, finer, rtol=1e-6, atol=1e-6)
    return "" if same else f"are {kinds} at {found}, but {other} at {finer} with short steps"


QUICK, STEPS = ("fold_of", "first_event", "follow"), ("steps",)
ALL = (*QUICK, "path in amplitude", "path")


def judged_family(seed: int, number: int, names: Collection[str] = ALL) -> tuple[Counter[str], list[str]]:
    """How many answers of each kind there are for one family, and a sentence for each wrong one."""
    counts, wrong, rng = Counter[str](), list[str](), np.random.default_rng([seed, number])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        laws, fewest = ((*FIVE, "power"), 2) if names == STEPS else (FIVE, 1)
        family, start = random_family(rng, laws)
        while family.impacts < fewest:
            family, start = random_family(rng, laws)
        law = f"{type(family.oscillator.stop.law).__name__}, {family.oscillator.n_modes} modes"
        for kind, sentence in judged(family, start, random_change(start.oscillator, rng), names):
            counts.update([kind, f"{kind}, wrong"] if sentence else [kind])
            if sentence:
                orbit = f"p{family.m} with {family.impacts} touches, {law}"
                wrong.append(f"family {number} of seed {seed} ({orbit}): {kind} {sentence}")
    return counts, wrong


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    for option, default in (("--families", 300), ("--first", 0), ("--seed", 1)):
        parser.add_argument(option, type=int, default=default)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--steps", action="store_true")
    options, total = parser.parse_args(), Counter[str]()
    names = STEPS if options.steps else QUICK if options.quick else ALL
    for number in range(options.first, options.first + options.families):
        counted, sentences = judged_family(options.seed, number, names)
        total += counted
        print(*(f"{sentence}\n" for sentence in sentences), sep="", end="", flush=True)
    print(*(f"{count:7d}  {kind}" for kind, count in sorted(total.items())), sep="\n")
