"""The frequency at which another spring does what the letter's does: that of the same f T.

By the letter's claim of universality the born period depends on f T alone, f the drive frequency and T the
damped free period.  A study that shows something at one of the letter's frequencies therefore takes, for any
other spring,

    f = f_letter T_letter/T,        T = single_mode.free_period_s of the scene,

and the letter's frequency itself for the letter's T.  The range within which a motion is followed scales
likewise.
"""

from __future__ import annotations

from collections.abc import Mapping

from studies.instruments.scene import Scene
from studies.published import FREE_PERIOD_S, PERIODS

__all__ = ["corresponding", "periods_of"]

SAME_PERIOD = 1e-3
"""Relative change of T within which a spring counts as the letter's: twice the error of its 40.80 ms."""

DIGITS = 5
"""To which frequencies of other springs are rounded, significant ones: they are printed and typed."""


def corresponding(scene: Scene, letter_hz: float) -> float:
    """The drive frequency of the scene's spring that has the f T of the letter's `letter_hz` [Hz]."""
    ratio = FREE_PERIOD_S / scene.single_mode.free_period_s
    return letter_hz if abs(ratio - 1.0) <= SAME_PERIOD else float(f"{letter_hz * ratio:.{DIGITS}g}")


def periods_of(scene: Scene) -> Mapping[float, int]:
    """The letter's frequencies, as those of the scene's spring [Hz], with the letter's periods."""
    return {corresponding(scene, f): m for f, m in PERIODS.items()}
