"""What a drive period costs: against modes, law, heyoka, and the arithmetic that none can avoid.

Claim: with one mode and the hard wall a drive period takes some tens of nanoseconds, two orders of magnitude
less than the fastest outside solver; with N modes and Hertz contact some microseconds, and no more than in
proportion to the modes.

Cases: Eq. (1) at the letter's six frequencies and excess 0.02, one orbit and 32 on two cores; the beam's p4
at 21.50 Hz and excess 0.013 against the number of modes, with Hertz's and the linear contact, and without a
touch; with eight modes against the excess; the first call of a fresh interpreter. With --peers heyoka runs in
turns with it, for Eq. (1) in its own loop, for the beam through the interface of all methods at the tolerance
that gives 1e-8 or better, with eight modes also at others; its error is that of mode 1 past a collision,
against the exact method, which `studies.work_precision` holds to 1e-15. "floor"
is the arithmetic of periods without a touch. Each motion is repeated and the median taken; nothing else of
the study runs meanwhile.

Run:     python -m studies.benchmarks [--peers]     1 min, --quick 10 s
Writes:  costs.csv, ratios.csv, costs.md (the table of the README), costs.png
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Annotated

from contact import ImpactOscillator, StroboscopicMap, simulate
from studies import letter
from studies.benchmarks.cases import HEYOKA, OURS, Row, batch_rows, beam_rows, single_rows
from studies.benchmarks.tables import EXCESS, PEER_TOLERANCE, cost_table, draw_costs, ratios_of
from studies.peers import HeyokaTaylor, missing_solvers
from studies.run import Run, study
from studies.scene import Scene, beam_at, harmonic, model_of

__all__ = ["benchmarks", "error_of", "first_call"]

FREQUENCY, EIGHT = 21.50, 8
"""The letter's Fig. 4 [Hz]; modes with which excess and tolerance are varied."""

COUNTS, COUNTS_QUICK = (1, 2, 4, 8, 15, 20, 40), (1, 8)
"""Numbers of modes."""

LAWS = ("hertz", "linear")
EXCESSES, TOLERANCES = (1e-4, 1e-3, 0.1), (1e-4, 1e-10, 1e-15)
"""Besides those of the table: from grazing to chaos; of heyoka."""

FIRST_CALL = """
import json, resource, time
began = time.perf_counter()
from contact import first_collision
from studies.scene import beam_at, model_of, read_scene
imported = time.perf_counter()
scene = read_scene("letter", ["modes.count=8"])
model = model_of(scene)
solved = time.perf_counter()
first_collision(beam_at(scene, 21.5, model).with_excess(0.013))
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps([imported - began, solved - imported, time.perf_counter() - solved, peak]))
"""


@study()
def benchmarks(
    scene: Scene, run: Run, *, peers: Annotated[bool, "run heyoka in turns with the package"] = False
) -> Mapping[str, object]:
    """Time, store and draw."""
    if peers and "heyoka" in missing_solvers():
        raise ValueError('heyoka is not installed; it comes with the extra peers: pip install -e ".[peers]"')
    quick, tolerance = run.quick, PEER_TOLERANCE if peers else None
    frequencies = sorted(letter.PERIODS)[: 2 if quick else None]
    counts = COUNTS_QUICK if quick else COUNTS
    model = model_of(harmonic(scene).replace({"modes.count": max(counts)}))
    beams = {law: beam_at(scene.replace({"contact.law": law}), FREQUENCY, model) for law in LAWS}
    jobs = [(law, n, EXCESS, tolerance) for law in LAWS for n in counts]
    if not quick:
        jobs += [(LAWS[0], EIGHT, excess, None) for excess in EXCESSES]
        jobs += [(LAWS[0], EIGHT, EXCESS, other) for other in TOLERANCES if peers]
    rows: list[Row] = []
    for frequency in run.track(frequencies, "Eq. (1)"):
        rows += single_rows(scene, frequency, quick=quick, peers=peers)
    rows += batch_rows(scene, frequencies[0], quick=quick, peers=peers)
    for law, n, excess, bound in run.track(jobs, "beam"):
        beam = replace(beams[law], model=model.truncated(n))
        found = beam_rows(f"beam, {law} contact", beam, excess, quick=quick, tolerance=bound)
        if bound is not None and n == EIGHT:
            error = error_of(beam.with_excess(excess), bound)
            found = [replace(row, error=error) if row.tool == HEYOKA else row for row in found]
        if (excess, bound) != (EXCESS, tolerance):  # a variation: only what varies
            varied = OURS if bound is None else HEYOKA
            found = [row for row in found if row.excess == excess and row.tool == varied]
        rows += found
    ratios, start = ratios_of(rows), first_call(1 if quick else 3)
    run.table("costs", rows, "Time per drive period and per collision.")
    run.table("ratios", ratios, "heyoka's time over ours, ours over the floor, growth with the modes.")
    run.text("costs.md", "\n".join(cost_table(rows)) + "\n")
    run.figure(
        "costs",
        draw_costs(rows),
        "Time per drive period against the number of modes, with two contact laws, without a touch, and the "
        "arithmetic that none can avoid.",
    )
    run.say("first call: " + ", ".join(f"{name} {number:.3g}" for name, number in start.items()))
    return {"rows": rows, "ratios": {one.name: one.ratio for one in ratios}, "first_call": start}


def error_of(oscillator: ImpactOscillator, tolerance: float) -> float:
    """heyoka's error of mode 1 after a drive period from the steady motion at a strobe, past a collision, in
    units of its displacement and velocity at grazing [1]."""
    start = StroboscopicMap(oscillator=oscillator).steady()
    exact, found = (
        simulate(oscillator, start, periods=1, method=method).end
        for method in (None, HeyokaTaylor(tolerance=tolerance))
    )
    size = oscillator.stop.gap / abs(float(oscillator.model.phi[0]))
    away = (found.displacement[0] - exact.displacement[0]) / size
    fast = (found.velocity[0] - exact.velocity[0]) / (size * 2.0 * math.pi / oscillator.period)
    return math.hypot(away, fast)


def first_call(repeats: int) -> dict[str, float]:
    """Medians of the seconds that a fresh interpreter takes for imports, modes and its first collision, with
    kernels that are kept; and its peak memory [MB]."""
    runs = []
    for _ in range(repeats):
        command = [sys.executable, "-c", FIRST_CALL]
        root = Path(__file__).resolve().parents[2]
        runs.append(
            json.loads(subprocess.run(command, cwd=root, capture_output=True, text=True, check=True).stdout)
        )
    names = ("imports_s", "modes_s", "first_collision_s", "peak_memory_mb")
    return {name: median(one[i] for one in runs) for i, name in enumerate(names)}


if __name__ == "__main__":
    raise SystemExit(benchmarks.main())
