"""The stop: a wall that rides on the base, at distance `gap` from the resting tip."""

from dataclasses import dataclass

from beam.parameters import final, require_kind, require_within
from contact.laws import ContactLaw


@final
@dataclass(frozen=True, kw_only=True)
class Stop:
    """A wall at tip displacement `gap` relative to the base, with the law of its contact.

    Parameters
    ----------
    gap : float
        Distance from the tip at rest to the wall, zero or more [m]; a driven spring needs more than zero.
    law : ContactLaw
        What happens when the tip reaches it.
    """

    gap: float
    law: ContactLaw

    def __post_init__(self) -> None:
        require_within("gap", self.gap, "m", low=0)
        require_kind("law of the stop", self.law, ContactLaw, "a contact law such as NewtonRestitution")
