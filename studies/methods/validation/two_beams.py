"""Two cantilevers that meet through a soft one-sided spring, measured on a shaker.

L. Woiwode and M. Krack, J. Struct. Dyn. (2024), doi 10.25518/2684-6500.180.  A mini-beam on the right strip
meets a cap nut on the left one across a gap.  Geometry, added masses and stiffness factors are those of their
beam model (maltekrack/NLtest, TESTRIGS/02_VIbeams/setUpLinearModalBeamModel.m).

The mini-beam, free at both ends, is tied to the right beam by w and theta at its root, R (x_right, x_mini) =
0; with N a basis of the null space of R, K = N^T K N and M = N^T M N.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import null_space
from scipy.sparse import block_diag, csr_array

import beam
from studies.methods.validation.printed import Printed, compared

LEFT, RIGHT = (30.95, 199.04, 556.82, 1085.93), (28.20, 205.54, 277.74, 594.98, 1168.62)  # measured, Hz
MODEL_ERROR = 0.03  # of frequencies: their beam model, tuned by hand, meets them to 1-3 %
LENGTH, WIDTH, HEIGHT, E, DENSITY = 0.3925, 0.060, 0.006, 210e9, 7720.0
CONTACT, ROOT, PLATE = LENGTH - 0.0115, LENGTH - 0.0625, 0.040


def _strip(
    pieces: Sequence[tuple[float, float, float]],
    nut: float,
    width: float = WIDTH,
    height: float = HEIGHT,
    held: beam.Support = "clamped",
    tip_at: float = CONTACT,
    tie: float = ROOT,
) -> beam.Discretization:
    """A strip, free at its far end, of pieces (length, stiffness over that of steel, added mass)."""
    steel = [
        beam.Material(
            youngs_modulus=factor * E, poissons_ratio=0.3, density=DENSITY + added / (length * width * height)
        )
        for length, factor, added in pieces
    ]
    return beam.assemble(
        beam.LeafSpring(
            centreline=beam.Centreline(pieces=tuple(beam.Straight(length=piece[0]) for piece in pieces)),
            sections=tuple(beam.StripSection(material=m, width=width, thickness=height) for m in steel),
            supports=(held, "free"),
            tip=beam.Tip(mass=nut),
            tip_at=tip_at,
            readouts={"w": beam.Readout(at=tie), "turn": beam.Readout(at=tie, quantity="rotation")},
        )
    )


def both_beams(plate_end: float = ROOT, count: int = 6) -> tuple[beam.Modes, beam.Modes]:
    """Modes of the left beam and of the right one with its mini-beam; the 40 mm of the tuning plate, or of
    the mini-beam's clamp, end at `plate_end` [m] from the support."""

    def bolted(bare: float, factor: float, plate: float, added: float) -> list[tuple[float, float, float]]:
        stiffness = bare * factor * (1.0 + plate * PLATE / WIDTH / HEIGHT) ** 3
        return [(plate_end - PLATE, bare, 0.0), (PLATE, stiffness, added), (LENGTH - plate_end, bare, 0.0)]

    left = _strip(bolted(1.0, 0.75, 1e-3, 0.0427), 0.0133)
    right = _strip(bolted(1.08, 0.1, 13.5e-3, 0.0307 * 40 / 97 + 0.0606 + 0.0543 + 0.0819), 0.0)
    excess = 0.0307 * 57 / 97 - DENSITY * 0.057 * 0.040 * 1e-3
    mini = _strip([(0.057, 1.07, excess)], 0.0, 0.040, 1e-3, "free", CONTACT - ROOT, 0.0)
    basis = null_space([np.append(right.readouts[x], -mini.readouts[x]) for x in ("w", "turn")])
    both = {
        name: csr_array(basis.T @ (block_diag([getattr(x, name) for x in (right, mini)]) @ basis))
        for name in ("stiffness", "mass", "loss_stiffness")
    }
    tied = replace(
        right,
        **both,
        base_load=np.append(right.base_load, mini.base_load) @ basis,
        tip=np.append(0.0 * right.tip, mini.tip) @ basis,
        ties=right.ties @ csr_array(basis[: -mini.n_dofs]),
        readouts={"beam": np.append(right.tip, 0.0 * mini.tip) @ basis},
    )
    return beam.natural_modes(left, count), beam.natural_modes(tied, count)


def two_beams() -> list[Printed]:
    """Frequencies of both beams beside the measured ones.

    Mode 5 of the right beam differs: exact transfer matrices of the published drawing give our number.
    """
    return [
        compared(
            "Woiwode and Krack 2024",
            f"{side} beam, mode {k}",
            f,
            float(a),
            MODEL_ERROR * f,
            f"{b:.5g} Hz with the plates 10 mm further out",
            "Hz",
        )
        for side, measured, here, out in zip(
            ("left", "right"), (LEFT, RIGHT), both_beams(), both_beams(ROOT + 0.01), strict=True
        )
        for k, f, a, b in zip(range(1, 6), measured, here.frequencies_hz, out.frequencies_hz, strict=False)
    ]
