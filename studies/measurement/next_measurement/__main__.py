"""Where a measurement tells most of the parameters, and what the letter's own six tell.

Question: how well do the strobes of one orbit, or of two, determine period, gap, restitution and delay? And
which free periods agree with the six pairs of frequency and period that the letter prints?

The information of an orbit is that of its strobe points, read with noise (`information`):

    M = (N/m) sum_j J_j^T J_j/s^2 + what is known before,      J_j = dy_j/dp, exact derivatives.

Over the plane of drive frequency and excess stand the standard errors of each parameter wanted, and the five
places with the smallest volume of their ellipsoid that the orbit outlives. The oscillator is one mode with a
constant restitution and delay. The letter's pairs are taken one by one (`pairs`): the free periods at which
p_m is born by the map's bands, and by Eq. (1) at several excesses, and what they have in common. They are
those of the letter's spring and left out for another.

Run:     python -m studies next_measurement --wanted free_period restitution delay
Writes:  measurements.csv (a row an orbit), next.csv (the best five), next.png; pairs.csv
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated

from beam import InvalidValue
from studies.measurement.next_measurement import information, pairs
from studies.physics.parameters import described, require_names
from studies.shell.scene import Scene, corresponding, harmonic
from studies.shell.study import Run, study

FREQUENCY_HZ = 22.20
"""The letter's p5: a scene that has it where the letter does is the letter's spring."""


@study(quick={"thin": 6})
def next_measurement(
    scene: Scene,
    run: Run,
    *,
    wanted: Annotated[tuple[str, ...], "parameters to tell"] = ("free_period", "restitution", "delay"),
    strobes: Annotated[int, "strobes of an orbit"] = 1000,
    noise_um: Annotated[float, "noise of the read-out"] = 0.5,
    delay_ms: Annotated[float | None, "delay of a touch (default: T/136)"] = None,
    thin: Annotated[int, "every so many places of the plane, both ways"] = 2,
) -> Mapping[str, object]:
    """Compute, tabulate, draw and say."""
    harmonic(scene)
    if not noise_um > 0.0:
        raise InvalidValue(f"noise_um is {noise_um:g} um; it must be above zero")
    delay = None if delay_ms is None else 1e-3 * delay_ms
    of = partial(described, scene, "two_parameters", delay)
    require_names(wanted, of(corresponding(scene, FREQUENCY_HZ)), "wanted")
    if "amplitude" in wanted:
        raise InvalidValue(
            "wanted names amplitude, which is measured with each orbit; name another parameter"
        )
    plan = information.Plan(names=wanted, strobes=strobes, noise=1e-6 * noise_um)
    plan = replace(plan, before={name: error for name, error in plan.before.items() if name not in wanted})
    ask = partial(information.measurements_at, of, plan, information.EXCESSES[::thin])
    frequencies = [corresponding(scene, f) for f in information.FREQUENCIES_HZ[::thin]]
    found = [one for column in run.map(ask, frequencies, "orbits") for one in column]
    best = information.best(found)
    run.table("measurements", found, f"What an orbit tells of {', '.join(wanted)}.", show=())
    run.table("next", best, "The five best of them.", show=("frequency_hz", "excess", "period", "together"))
    run.figure(
        "next",
        information.draw(found, plan),
        "Standard errors over frequency and excess; stars: "
        "letter; numbers: the best five; grey: the orbit does not outlive its errors.",
    )
    told, rows = list[str](), list[pairs.Interval]()
    if corresponding(scene, FREQUENCY_HZ) == FREQUENCY_HZ:
        if plan.names == information.Plan().names:
            told.append(information.answer(of, found, plan))
        ask_pairs = partial(pairs.intervals_of, described(scene, "one_mode", 0.0, FREQUENCY_HZ))
        columns = run.map(ask_pairs, pairs.EXCESSES[: 2 if run.quick else None], "pairs")
        rows = [row for column in columns for row in column]
        run.table("pairs", rows, "Free periods at which the letter's six pairs are born.", show=())
        told += [] if run.quick else [pairs.sentence(rows)]
    for sentence in told:
        run.say(sentence)
    if told:
        run.answer("period", " ".join(reversed(told)))
    return {"rows": best, "pairs": rows, "told": told}
