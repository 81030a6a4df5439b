"""How finely the curves of one approach to the plate are sampled: in full, or for a first look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studies.published import TIME_TRACE_EXCESS

__all__ = ["Grid"]


@dataclass(frozen=True, kw_only=True)
class Grid:
    """How finely the curves are sampled.

    `modes` are kept everywhere but on the mode curve, which runs up to them and has one point more at
    `check_modes`: what has settled stays where it is.
    """

    modes: int
    check_modes: int
    excesses: tuple[float, ...]
    mass_excesses: tuple[float, ...]
    mass_ratios: tuple[float, ...]
    stiffnesses: tuple[float, ...]
    factors: tuple[float, ...]
    restitutions: tuple[float, ...]
    hardnesses: tuple[float, ...]

    @staticmethod
    def full() -> Grid:
        """About a thousand collisions."""
        return Grid(
            modes=40,
            check_modes=60,
            excesses=(*np.geomspace(1e-5, 5e-2, 38).tolist(), *np.geomspace(5e-2, 0.4, 9)[1:].tolist()),
            mass_excesses=(1e-4, 3e-4, 1e-3, 3e-3, TIME_TRACE_EXCESS, 5e-2),
            mass_ratios=(
                0.0,
                0.02,
                0.05,
                0.1,
                0.125,
                0.15,
                0.175,
                0.2,
                0.225,
                0.25,
                0.275,
                0.3,
                0.325,
                0.35,
                0.4,
                0.5,
                0.7,
                1.0,
                1.4,
                2.0,
                3.0,
            ),
            stiffnesses=tuple(np.geomspace(1e2, 1e7, 31).tolist()),
            factors=tuple(np.geomspace(0.1, 10.0, 9).tolist()),
            restitutions=(1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1),
            hardnesses=(1.0, 3.0, 10.0, 30.0, 100.0, 300.0),
        )

    @staticmethod
    def quick() -> Grid:
        """The same curves with fewer points."""
        return Grid(
            modes=20,
            check_modes=28,
            excesses=tuple(np.geomspace(1e-5, 0.4, 13).tolist()),
            mass_excesses=(1e-3, TIME_TRACE_EXCESS),
            mass_ratios=(0.0, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0),
            stiffnesses=tuple(np.geomspace(1e2, 1e7, 6).tolist()),
            factors=(0.1, 1.0, 10.0),
            restitutions=(1.0, 0.5, 0.2),
            hardnesses=(1.0, 10.0, 100.0),
        )
