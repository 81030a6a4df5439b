"""What can go wrong in a computation of impacts, as one small family.

Wrong use (a negative stiffness, a law that a method cannot handle) is a ``beam.Refusal``, a ValueError or
TypeError, where the object is made.  The classes here are for valid computations that could not be finished.
They carry time and place of the failure, and never a number that might be taken for a result.
"""

import pickle
from contextlib import suppress
from inspect import cleandoc


class ContactError(RuntimeError):
    """A computation of impacts that could not be finished.

    An error keeps the time and the place of the failure.  Its numbers are zero where a search for an orbit
    has failed.

    Parameters
    ----------
    time : float
        Time of the failure since the start of the drive [s].
    gap : float
        Distance of the tip from the stop, positive when the tip is free [m].
    velocity : float
        Velocity of the tip towards the stop [m/s].
    detail : str
        Words that end the message.
    """

    reason = "the computation could not be finished"

    def __init_subclass__(cls) -> None:
        """All errors of the family have the parameters of this one, also in their docstrings."""
        parameters = cleandoc(ContactError.__doc__ or "").partition("\n\nParameters")[1:]
        cls.__doc__ = "".join((cleandoc(cls.__doc__ or ""), *parameters))

    def __init__(
        self, *, time: float = 0.0, gap: float = 0.0, velocity: float = 0.0, detail: str = ""
    ) -> None:
        self.time, self.gap, self.velocity = time, gap, velocity
        place = f"at t = {time:.9g} s, {gap:.3g} m from the stop, velocity {velocity:.3g} m/s"
        super().__init__(f"{self.reason} {place}{'; ' + detail if detail else ''}")

    def __reduce__(self) -> tuple[object, ...]:
        """The sentence and what can be pickled, so that an error leaves a process of workers as itself."""
        kept = dict[str, object]()
        for name, value in self.__dict__.items():
            with suppress(pickle.PicklingError, AttributeError, TypeError):
                pickle.dumps(value)  # fails for an orbit under a law of functions
                kept[name] = value
        return type(self).__new__, (type(self), *self.args), kept


class UnresolvedCrossing(ContactError):
    """A part of the motion that could be proved neither free nor touching."""

    reason = "a crossing of the stop could be neither excluded nor located"


class TouchedAtOnce(ContactError):
    """Two stops touched at once under a law that is followed alone, or more than eight that act."""

    reason = "two stops are touched at once, which is not followed under their laws,"


class Chatter(ContactError):
    """More impacts in one drive period than the bound allows."""

    reason = "impacts accumulate"


class ContactTooStiff(ContactError):
    """A contact that needs more steps than the bound allows."""

    reason = "a contact needs more integration steps than the bound allows"


class StepTooLarge(ContactError):
    """A time step beyond the limit of stability of its method, in flight or in the contact at hand."""

    reason = "the time step is beyond the limit of stability"


class Diverged(ContactError):
    """A discretised motion that has grown without bound, or one mode beyond the range of its cubic terms."""

    reason = "the motion grew without bound"


class NotPeriodic(ContactError):
    """An orbit that should be periodic and is not."""

    reason = "the motion did not settle on a periodic orbit"


class BranchEnded(ContactError):
    """A branch of periodic orbits that ends before the event that is looked for.

    Its attribute `orbit` is the last orbit of the branch.  It is None if there is no orbit to start from, or
    if its law has functions and the error comes from another process.
    """

    reason = "the branch of periodic orbits ends"
    orbit: object = None


class NoDerivative(ContactError):
    """A motion or orbit that does not depend smoothly on its start or its numbers."""

    reason = "there is no derivative"
