"""The letter's other claims, each with the numbers that decide it.

Claims (letter 1996), for the Nordmark map (Eqs. (2), (3)), Eq. (1) and springs with many modes; the words of
the letter and the mathematics are in the files of studies.instruments.claims named here:

    a   the hysteresis falls with the energy lost           hysteresis_and_loss
    b   secondary bifurcations above and below grazing      second_impact, secondary_bifurcation
    c   bands in the (alpha, gamma) plane                   bands
    d   the same for all springs and contact laws           universality
    e   period adding of the overdamped oscillator          overdamped_map, overdamped_windows

Run time: about a minute; --quick some ten seconds.  Command: python -m studies.claims.  Outputs: summary.json
with {"holds", "numbers", "sentence"} for each claim, and a figure (png, pdf) and a csv for each.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from studies.instruments.adequacy.fitted_scene import Need
from studies.instruments.claims.bands import bands_claim
from studies.instruments.claims.hysteresis_and_loss import hysteresis_claim
from studies.instruments.claims.overdamped_windows import overdamped_claim
from studies.instruments.claims.second_impact import secondary_claim
from studies.instruments.claims.universality import universality_claim
from studies.instruments.claims.verdict import Claim
from studies.instruments.command_line import Request, run_study
from studies.instruments.scene import Scene


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    began = time.perf_counter()
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; the claims need a harmonic drive")
    quick = request.quick
    names = {"a": "hysteresis", "b": "secondary", "c": "bands", "d": "universality", "e": "overdamped"}
    makers: dict[str, Callable[[], Claim]] = {
        "a": lambda: hysteresis_claim(scene),
        "b": lambda: secondary_claim(scene, quick),
        "c": lambda: bands_claim(scene, quick),
        "d": lambda: universality_claim(scene, quick, request.workers),
        "e": lambda: overdamped_claim(quick),
    }
    claims = {}
    with request.progress("claims", total=len(makers)) as progress:
        for key, make in makers.items():
            claim = make()
            stem = f"{key}_{names[key]}"
            request.record.write_table(stem, claim.table)
            request.record.write_figure(claim.figure, stem)
            claims[key] = claim.as_dict()
            progress.advance()
            print(f"({key}) holds: {claim.holds}. {claim.sentence}", flush=True)
    failed = int(claims["d"]["holds"] is None)
    return {"claims": claims, "failed_cells": failed, "wall_s": time.perf_counter() - began}


NEEDS = (Need(quantity="fold", tolerance=0.05, everywhere=True),)
"""What the numbers rest on: modes and mesh are chosen for it."""


def main(argv: Sequence[str] | None = None, *, module: str | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "claims", "The letter's other claims, each with the numbers that decide it.", run, argv,
        module=module, needs=NEEDS,
    )


if __name__ == "__main__":
    raise SystemExit(main())
