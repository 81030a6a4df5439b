"""Where each numerical method fails: theory beside measurement.

Claim: a method for impacts fails by its step, by what it does to the energy of a contact, by a touch that it
does not see, or by impacts that accumulate, and each of these failures lies where theory puts it. Six
families, each derived at the head of its file:

    explicit             central difference: limits of the step; energy made in short contacts within them
    splitting            the stiffest contact that kick-flight-kick bears, and resonances beyond h omega = pi
    implicit_energy      the trapezoidal rule multiplies the energy of a stiff contact by e^0.7465 on average
    false_restitution    loss or gain that a step adds to an elastic collision
    missed_crossings     crossings that lie between two looks
    accumulation         infinitely many impacts in a finite time, counted one by one

A row: family; method; case; the parameter with its unit; theory (empty where it gives no number); measured
(empty where the failure did not appear); refused: whether the package refuses to go beyond before a number
comes out (empty where there is nothing to refuse).

Run:     python -m studies stability [--families explicit,splitting] [--quick]
Writes:  limits.csv (all rows); for three families NAME.npz (arrays of its figure) and NAME.png
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated

from beam import InvalidValue
from studies.methods.stability import FAMILIES, Limit, family, findings
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
            run.arrays(name, **arrays)
            run.figure(name, *family(name).draw(arrays))
    run.table("limits", rows, "Where methods fail: theory and measurement.", of=Limit)
    return {"rows": rows}
