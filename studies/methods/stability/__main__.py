"""Where each numerical method fails: theory beside measurement.

Claim: a method for impacts fails by its step, by what it does to the energy of a contact, by a touch that it
does not see, or by impacts that accumulate, and each of these failures lies where theory puts it:

    explicit             central difference: limits of the step; energy made in short contacts within them
    splitting            the stiffest contact that kick-flight-kick bears, and resonances beyond h omega = pi
    implicit_energy      the trapezoidal rule multiplies the energy of a stiff contact by e^0.7465 on average
    false_restitution    loss or gain that a step adds to an elastic collision
    missed_crossings     crossings that lie between two looks
    accumulation         infinitely many impacts in a finite time, counted one by one

Run:     python -m studies stability [--families explicit,splitting] [--quick]
Writes:  limits.csv (all rows); for three families NAME.npz (arrays of its figure) and NAME.png
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Annotated

from beam import InvalidValue
from studies.methods.stability.model import FAMILIES, Limit, family, findings
from studies.shell.digits import written
from studies.shell.run import MOST_FINDINGS
from studies.shell.scene import Scene
from studies.shell.study import Run, study


@study()
def stability(
    scene: Scene,
    run: Run,
    *,
    families: Annotated[str, "only these families, separated by commas (default: all)"] = "",
) -> Mapping[str, object]:
    """Measure the families, store and draw them."""
    names = [name.strip() for name in families.split(",")] if families else list(FAMILIES)
    for name in names:
        if name not in FAMILIES:
            raise InvalidValue(f"families names {name!r}; it must be among {', '.join(FAMILIES)}")
    rows: list[Limit] = []
    found = run.attempt(partial(findings, scene=scene, quick=run.quick), names, "families")
    for name, result in zip(names, found, strict=True):
        if result is None:
            continue
        limits, arrays = result
        rows += limits
        if arrays:
            run.arrays(name, family(name).HOLDS, **arrays)
            run.figure(name, *family(name).draw(arrays))
    run.table("limits", rows, "Where methods fail: theory and measurement.", of=Limit)
    for sentence in list(sentences(rows))[:MOST_FINDINGS]:
        run.finding(sentence)
    return {"rows": rows}


def sentences(rows: Sequence[Limit]) -> Iterator[str]:
    """What the families found, the clearest failure first; what was not measured is not said."""
    known = [(row, row.theory or math.nan, row.measured) for row in rows if row.measured is not None]
    if growth := [found for row, _, found in known if row.parameter.startswith("mean of ln")]:
        factor = written(math.exp(growth[0]), 2)
        yield f"The trapezoidal rule multiplies the energy of a stiff contact by {factor} on average."
    deep = [x for row, _, x in known if row.parameter == "overshoot / gap" and row.method.startswith("SciPy")]
    if deep:
        part = written(100.0 * max(deep), 2)
        yield f"SciPy's event search at worst misses half of the crossings {part} % of the gap deep."
    limits = [abs(found / theory - 1.0) for row, theory, found in known if row.refused]
    if limits and max(limits) < 1e-3:
        yield "Steps and stiffnesses that are too large fail where theory puts their limits."
    raised = max((found for row, _, found in known if row.parameter == "restitution τ"), default=0.0)
    if raised:
        yield f"With a step as long as the contact, the restitution comes out as up to {written(raised, 2)}."
    if ends := [found for row, _, found in known if row.case.endswith("falls through")]:
        yield f"An event loop without proof falls through the stop after {written(min(ends))} impacts."
