"""Warnings of sizes that no leaf spring and no exciter has."""

import math

from beam import ModalModel
from beam.parameters import suspect
from contact.drive import HarmonicDrive

GREATEST_GAP = 1.0  # gap beyond which a warning is given [m]; lengths in units of the gap give just this

GREATEST_AMPLITUDE = 0.1
"""Amplitude of a base motion beyond which a warning is given [m]: the stroke of large vibration exciters is
50 mm, and the letter's drive moved by 1.5 mm.  Exactly 1 asks for the response per unit amplitude."""

HIGHEST_DRIVE, SLOWEST_DRIVE = 2.0, 0.01
"""Drive frequencies above the first, over the highest mode, and below the second, over the lowest one, bring
a warning: a mode is missing, or the tip moves by less than 1e-4 of the motion of the base."""


def suspect_sizes(model: ModalModel, gap: float, drive: HarmonicDrive | None) -> None:
    """Warn of a largest `gap` [m] or an amplitude in other units than metres, unless the model is
    `dimensionless`, and of a drive frequency that no exciter of this spring has."""
    amplitude = 0.0 if drive is None else drive.amplitude
    remedy = "millimetres may have been meant; in units of your own give ModalModel(dimensionless=True)"
    if gap > GREATEST_GAP and not model.dimensionless:
        suspect(f"gap is {gap:g} m; above {GREATEST_GAP:g} m no leaf spring moves that far, and {remedy}")
    large = amplitude > max(GREATEST_AMPLITUDE, 10.0 * gap) and amplitude != 1.0
    if large and not model.dimensionless:
        given = f"amplitude of the drive is {amplitude:g} m with a gap of {gap:g} m"
        suspect(f"{given}; exciters move by some centimetres at most, and {remedy}")
    if drive is None:
        return
    given = f"frequency of the drive is {drive.frequency:g}"
    highest, turn = float(model.omega.max()), 2.0 * math.pi
    if 0.0 < HIGHEST_DRIVE * highest < drive.angular_frequency:
        above = f"far above the highest retained mode at {highest / turn:g} Hz"
        suspect(f"{given} Hz, {above}; modes that the drive excites are missing")
    lowest = min((x for x in model.omega.tolist() if x > 0.0), default=0.0)
    if drive.angular_frequency < SLOWEST_DRIVE * lowest:
        words = f"at {lowest / turn:g} Hz; the spring then follows its base and does not bend"
        suspect(f"{given} Hz, below {SLOWEST_DRIVE:g} of the lowest mode {words}")
