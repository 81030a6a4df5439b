"""What the six transitions owe to the letter's errors and to what it leaves open.

Claims (letter 1996): T = 40.80 +- 0.02 ms; the last of the six transitions goes to p10.

Computed: born period at excess 1e-3 and fold F_m/F_g - 1 at each of the six frequencies after each change of
one parameter, in Nordmark's map, Eq. (1) and the beam; which changes bring p10. (Noise:
studies.measurement.noise.)

Run:     python -m studies sensitivity
Writes:  sensitivity.csv (a row a frequency and change), p10.csv (a row a cause), and the figure
         fold_against_parameter
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from studies.experiment.sensitivity.changes import changes_of, row_at, rows_after
from studies.experiment.sensitivity.p10 import Row, causes_of, row_of
from studies.letter import PERIODS
from studies.shell.scene import Scene, SceneError, harmonic, model_of
from studies.shell.study import Run, study

HIGHEST = max(PERIODS.values())
"""m of the last transition that the letter saw."""


@study(needs={"fold": 0.05})
def sensitivity(scene: Scene, run: Run) -> Mapping[str, object]:
    """Compute, store and draw."""
    if harmonic(scene).spring.kind == "modal_data":
        raise SceneError("spring.kind is modal_data; this study varies the dimensions of a spring")
    model, frequencies = model_of(scene), sorted(scene.drive.frequencies_hz)
    base = run.map(partial(row_at, scene, model), frequencies, "frequencies")
    changes = changes_of(scene, run.quick)
    after = run.attempt(partial(rows_after, scene, base), changes, "changes")
    rows = base + [row for found in after for row in found or ()]
    run.table("sensitivity", rows, "Born period and fold after each change of one parameter.")
    causes = causes_of(scene, model)[: 20 if run.quick else None]
    p10 = run.map(partial(row_of, scene, 1.5 if run.quick else 1.05), causes, "causes of p10")
    run.table(
        "p10",
        p10,
        "Period born at the letter's last frequency at excess 2.5e-4, 1e-3, 4e-3 and 1e-2, "
        "how many of its other five are; excesses with p10 and with all six.",
    )
    from studies.experiment.sensitivity import figure  # matplotlib is slow to import

    run.figure("fold_against_parameter", figure.draw_tornado(rows), figure.TORNADO)
    judge(run, p10)
    return {
        "rows": rows,
        "p10": p10,
        "free_period_for_it_at_grazing_s": 2.0 * HIGHEST / ((2.0 * HIGHEST + 1.0) * frequencies[-1]),
    }


def judge(run: Run, rows: Sequence[Row]) -> None:
    """The answer why it is p10."""

    def told(found: Sequence[Row]) -> str:
        return "; ".join(
            f"{row.cause}, " + (f"{row.six_from:.1e} to {row.six_to:.1e}" if row.six_from else "nowhere")
            for row in found
        )

    near = [row for row in rows if row.born[1] == HIGHEST and row.others[1] == len(PERIODS) - 1]
    run.answer(
        "last_period",
        f"Excesses at which all six periods are born, with nothing changed: {told(rows[:3])}; with what "
        f"brings them to 1e-3: {told(near)}. The letter prints neither the excess at which a period was read "
        "nor gap, width, exciter and the base on which T was measured: it cannot decide between these.",
    )
