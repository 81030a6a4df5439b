"""Are the stated errors true? The share of 90 % intervals that hold the values of known oscillators.

Record i of trial k has the noise of the read-out (of a table: of the amplitude) from the seed (SEED, k, i),
whoever computes it. Fits start at the true values, which what they find does not depend on. A share p of n
intervals is uncertain by sqrt(p (1 - p)/n). Last comes a model that is too small, Eq. (1) fitted to records
of the beam: its intervals mean nothing, and the residuals must say so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from beam import Refusal
from contact import ContactError, ImpactOscillator
from studies import letter
from studies.measurement.identify.fit import LEVEL, fit
from studies.measurement.identify.records import READ_OUT, Kind, Record, synthetic
from studies.physics.parameters import parameters_of
from studies.shell.files import fingerprint
from studies.shell.scene import Scene, beam_at, model_of, single_mode_at
from studies.shell.study import Run
from studies.shell.sweep import sweep

COVERED = "Share of 90 % intervals that hold the true value, with its binomial error."
SEED, FREQUENCY_HZ = 1996, 22.20
CHUNK = 10
"""Records a column of the sweep, which is stored: an interrupted count goes on."""

KINDS: dict[Kind, tuple[str, ...]] = {
    "strobe": ("free_period", "decay_rate", "gap"),
    "displacement": ("free_period", "decay_rate", "gap"),
    "transitions": ("free_period", "decay_rate"),
}
"""What is fitted to each kind, of Eq. (1) the restitution besides."""

TABLE = ((20.6, 3), (21.3, 4), (21.9, 5), (22.4, 6), (22.7, 7), (22.9, 8))
"""Transitions inside the bands of their periods [Hz], m: near an edge, as the letter's, p_m may not exist."""

LARGEST = {"Eq. (1)": 0.025, "beam": 0.05}
"""Difference of a share from 90 % that agrees, if it is above twice the error of such a share."""
OFTEN = 0.05
"""Part of the fits that may call a model too small that is not, or not one that is."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """`record` is one without noise of the oscillator `of` that name, `start` what is fitted to it; `short`
    says that it has fewer modes."""

    name: str
    of: str
    short: bool
    record: Record
    truth: dict[str, float]
    start: ImpactOscillator

    def column(self, key: int, chunk: int) -> dict[str, NDArray[np.generic]]:
        """Of a chunk of records: estimates, their standard errors and half widths of their intervals, (CHUNK,
        parameters), not a number where a record was refused, and which found the model too small."""
        found, small = np.full((3, CHUNK, len(self.truth)), np.nan), np.zeros(CHUNK)
        noise = letter.AMPLITUDE_STABILITY if self.record.kind == "transitions" else READ_OUT
        for i in range(CHUNK):
            seed = np.random.SeedSequence([SEED, key, chunk * CHUNK + i]).generate_state(1)
            try:
                one = fit(self.record.noisy(int(seed[0]), noise), self.start, tuple(self.truth))
            except (ContactError, Refusal):
                continue
            width = one.intervals()[:, 1] - one.estimate
            found[:, i] = [row[: len(self.truth)] for row in (one.estimate, one.errors, width)]
            small[i] = one.too_small
        return {"estimate": found[0], "error": found[1], "width": found[2], "small": small}


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """One parameter of a trial: the `share` of intervals that hold its true value, of `records` less those
    `refused`; mean (`bias`) and standard deviation (`spread`) of the errors made in units of those stated;
    the part of the fits that called the model too small. `agrees` says that the share does, or that the
    model that is too small is called so."""

    trial: str
    parameter: str
    records: int
    refused: int
    share: float
    share_error: float
    bias: float
    spread: float
    too_small: float
    agrees: bool


def trials(scene: Scene, beam: Scene) -> Iterator[Trial]:
    """Each kind of record of Eq. (1), of the beam, and of the beam for Eq. (1)."""
    excess = scene.scan.born_excess
    made = {
        "Eq. (1)": single_mode_at(scene, FREQUENCY_HZ).with_excess(excess),
        "beam": beam_at(beam, FREQUENCY_HZ, model_of(beam)).with_excess(excess),
    }
    for of, fitted in (("Eq. (1)", "Eq. (1)"), ("beam", "beam"), ("beam", "Eq. (1)")):
        for kind, names in KINDS.items():
            if of != fitted and kind == "transitions":
                continue  # six numbers, that do not say how well they are known
            known, own = parameters_of(made[fitted]), names + ("restitution",) * (fitted == "Eq. (1)")
            yield Trial(
                name=f"{of}, {kind}" + f", by {fitted}" * (of != fitted),
                of=of,
                short=of != fitted,
                record=synthetic(kind, made[of], transitions=TABLE),
                truth={name: known[name].value for name in own},
                start=made[fitted],
            )


def coverage(scene: Scene, beam: Scene, run: Run, *, records: int, beam_records: int) -> list[Coverage]:
    """Draw, fit and count; `beam` is the scene with the number of modes chosen."""
    rows = list[Coverage]()
    for key, trial in enumerate(trials(scene, beam)):
        chunks = math.ceil((beam_records if trial.of == "beam" else records) / CHUNK)
        settings = {"trial": trial.name, "seed": SEED, "chunks": chunks}
        own = fingerprint(beam.values(), settings)[:12]  # of the sources too: another fit is done again
        columns = sweep(run, f"coverage-{own}", settings, range(chunks), partial(trial.column, key))
        whole = {name: np.concatenate([one[name] for one in columns if one]) for name in columns[0] or ()}
        fitted = np.isfinite(whole["error"][:, 0])
        count, small = max(int(fitted.sum()), 1), float(np.mean(whole["small"][fitted]))
        off = whole["estimate"][fitted] - np.array(list(trial.truth.values()))
        shares, ratios = np.mean(np.abs(off) <= whole["width"][fitted], axis=0), off / whole["error"][fitted]
        most = max(LARGEST[trial.of], 2.0 * math.sqrt(LEVEL * (1.0 - LEVEL) / count))
        for k, (name, share) in enumerate(zip(trial.truth, shares.tolist(), strict=True)):
            right = abs(share - LEVEL) <= most and small < OFTEN
            rows.append(
                Coverage(
                    trial=trial.name,
                    parameter=name,
                    records=fitted.size,
                    refused=int(np.sum(~fitted)),
                    share=share,
                    share_error=math.sqrt(share * (1.0 - share) / count),
                    too_small=small,
                    bias=float(ratios[:, k].mean()),
                    spread=float(ratios[:, k].std()),
                    agrees=small > 1.0 - OFTEN if trial.short else right,
                )
            )
    return rows
