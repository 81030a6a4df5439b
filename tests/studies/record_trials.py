"""How often `fit` ends on records of `record_simulators`, and how often its intervals hold the truth.

    PYTHONPATH=. python tests/studies/record_trials.py KIND FIRST LAST [--workers 2]

The drive is given for even seeds, its frequency off by at most 1e-3 and its amplitude by at most 2 %; for odd
seeds it is not.  CPU time counts all threads: set OPENBLAS_NUM_THREADS=1.
"""

import time
from argparse import ArgumentParser
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
import record_simulators as simulators
from record_information import blind, truth_of

from beam import ModalModel, Refusal, single_mode
from contact import ContactError, HarmonicDrive, ImpactOscillator, LinearContact, NewtonRestitution, Stop
from studies.measurement.identify.fit.result import TOO_SMALL
from studies.measurement.identify.fit.search import fit
from studies.measurement.identify.record.records import Record
from studies.measurement.identify.report import estimates_of
from studies.physics.parameters import with_values

PARTS = ("estimate", "low90", "high90", "standard_error")
WARM = {"equation_1": 11, "two_modes": 0}  # seeds of quick fits, by which each process loads its kernels
HEADING = "records,fitted,too small,refused,errors,> 5 sigma,CPU median [s],CPU most [s]".split(",")


@dataclass(frozen=True)
class Trial:
    """A fit of one record, whose orbit lasts `period` drive periods.

    `outcome` is fit, refused or error, `sentence` the message of the last two, `unseen` the names that a
    refused record cannot determine; `cpu` [s] includes the intervals; `values` of each name are the truth
    and, if there is a fit, `PARTS`.
    """

    kind: str
    seed: int
    period: int
    drive_known: bool
    outcome: str
    sentence: str
    chance: float
    cpu: float
    unseen: str
    values: dict[str, list[float]]

    def sound(self) -> bool:
        """Whether there is a fit with residuals like noise."""
        return self.outcome == "fit" and self.chance >= TOO_SMALL

    def off(self) -> dict[str, float]:
        """Each error over the standard deviation that the 90 % interval states to the side of the truth."""
        found = {name: value[:4] for name, value in self.values.items() if len(value) > 1}
        sides = {n: at - low if at > true else high - at for n, (true, at, low, high) in found.items()}
        return {n: (v[1] - v[0]) / max(sides[n] / 1.645, 1e-99) for n, v in found.items()}


def begun(record: simulators.Record, seed: int, known: bool) -> tuple[Record, ImpactOscillator]:
    """The record as it is given to the fit, its drive perhaps known, and the oscillator to start from."""
    lab, random, given = record.beam, np.random.default_rng([seed, 1]), {}
    drive = {"frequency": 1.3 * lab.frequency, "amplitude": 1e-3}  # the fit must not use it
    if known:
        off = 1.0 + random.uniform(-1.0, 1.0, 2) * (1e-3, 0.02)
        drive = given = {"frequency": lab.frequency * off[0], "amplitude": lab.amplitude * off[1]}
    model, gap = single_mode(free_period=40.8e-3, decay_rate=3.56), 0.01
    law = NewtonRestitution(local_restitution=0.2)
    if lab.stiffness is not None:
        model = ModalModel(omega=lab.omega, decay_rate=lab.c, phi=lab.phi, participation=lab.gamma)
        law, gap = LinearContact(stiffness=2.0 * lab.stiffness), lab.gap * random.uniform(0.8, 1.2)
    start = ImpactOscillator(model=model, stop=Stop(gap=gap, law=law), drive=HarmonicDrive(frequency=24.0))
    rows = np.column_stack([record.time, record.value])
    return Record(columns=("time_s", "x_m"), rows=rows, **given), with_values(start, drive)


def trial_of(kind: str, seed: int) -> Trial:
    """Draw, fit and compare."""
    record = simulators.draw(kind, seed)
    values = {name: [value] for name, value in truth_of(record.beam).items()}
    given, start = begun(record, seed, seed % 2 == 0)
    outcome, sentence, chance, begin = "fit", "", 0.0, time.process_time()
    try:
        found = fit(given, start, tuple(values))
        rows, chance = {row.parameter: row for row in estimates_of("", found)}, found.chance
        values = {n: value + [getattr(rows[n], part) for part in PARTS] for n, value in values.items()}
    except (Refusal, ContactError) as error:
        outcome, sentence = "refused", str(error)
    except Exception as error:
        outcome, sentence = "error", f"{type(error).__name__}: {error}"
    cpu, unseen = time.process_time() - begin, blind(record) if outcome == "refused" else ""
    about = int(record.period), seed % 2 == 0
    return Trial(kind, seed, *about, outcome, sentence, float(chance), cpu, unseen, values)


def table(trials: list[Trial]) -> Iterator[str]:
    """Markdown: counts; shares of intervals that hold the truth where residuals are like noise."""
    sound, cpu = [one for one in trials if one.sound()], [one.cpu for one in trials]
    fitted, *ends = (sum(one.outcome == end for one in trials) for end in ("fit", "refused", "error"))
    far = sum(max(map(abs, one.off().values())) > 5.0 for one in sound)
    values = {name: [one.values[name] for one in sound] for name in trials[0].values}
    held = [100 * np.mean([low <= true <= high for true, _, low, high, _ in values[name]]) for name in values]
    counts = map(str, [len(trials), fitted, fitted - len(sound), *ends, far])
    row = [*counts, f"{np.median(cpu):.1f}", f"{max(cpu):.1f}", *(f"{share:.0f}" for share in held)]
    heading = [*HEADING, *(f"{name} [%]" for name in values)]
    yield from (f"| {' | '.join(line)} |" for line in (heading, ["--:"] * len(row), row))


def main() -> None:
    """The program."""
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=simulators.KINDS)
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int)
    parser.add_argument("--workers", type=int, default=2)
    own = parser.parse_args()
    warm = own.kind, WARM[own.kind]
    with ProcessPoolExecutor(own.workers, initializer=trial_of, initargs=warm) as pool:
        trials = [*pool.map(partial(trial_of, own.kind), range(own.first, own.last + 1))]
    print(*table(trials), "", *(one for one in trials if not one.sound()), sep="\n")


if __name__ == "__main__":
    main()
