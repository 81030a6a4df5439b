"""The two answers that stand first: the hysteresis, and what higher modes do to a collision.

Every number is read from what `studies.hysteresis`, `studies.effective_impact` and `studies.soft_wall`
stored.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from studies.instruments.report.declared.effective_impact import MILLI, reference
from studies.instruments.report.declared.hysteresis import causes
from studies.instruments.report.declared.soft_wall import smoothing
from studies.instruments.report.entry import asked
from studies.instruments.report.markup import Table
from studies.instruments.report.stored import Stored

LOWERED = 0.9
"""A smallest restitution below this part of the one without loss is lowered by the loss."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """What one study contributes to an answer."""

    study: str
    words: Callable[[Mapping[str, Any]], str]
    tables: Callable[[Mapping[str, Any]], list[Table]]


@dataclass(frozen=True, kw_only=True)
class Answer:
    """A question and the studies that answer it."""

    key: str
    question: str
    parts: tuple[Part, ...]


def of_hysteresis(summary: Mapping[str, Any]) -> str:
    factors, over = summary["factors"], summary["causes"]["over_all"]
    effects = sorted(over.items(), key=lambda item: item[1]["factor"])
    (least, down), (most, up) = effects[0], effects[-1]

    def off(name: str, digits: int = 2) -> str:
        found = factors[name]
        return f"{found['median']:.{digits}f} (median; worst {found['worst']:.{max(digits - 1, 1)}f})"

    opposite = down["factor"] < 1.0 < up["factor"]
    two, own = factors["two_parameters"], factors["map_measured_kick"]
    said = (
        "The map has the periods and the bands, not the size of the hysteresis. The difference is a product "
        f"of causes{' of opposite sign' if opposite else ''}: in the median {most} multiplies the hysteresis "
        f"by {up['factor']:.2f}, {least} by {down['factor']:.2f}. Over {factors['map']['count']} folds the "
        f"map is off by {off('map')}, Eq. (1) by {off('single_mode')}, one mode with the measured loss and "
        f"delay by {off('two_parameters')}, the kick of all modes by {off('all_mode_kick', 4)}."
    )
    if two["median"] < own["median"]:
        said += (
            " The letter's two parameters carry the higher modes as far as these have died out when the tip "
            "comes back; the map does not carry the two parameters."
        )
    return said


def of_collision(summary: Mapping[str, Any]) -> str:
    found, least = summary["answers"]["reference"], summary["answers"]["smallest_restitution"]
    loss = summary["answers"]["local_loss"]
    settled = [
        orbit["restitution"] for orbit in loss["settled_orbits"]["orbits"] if orbit["restitution"] is not None
    ]
    by_loss = loss["lossy_floor"] < LOWERED * loss["elastic_floor"]
    floor = (
        f"loss in the contact lowers that to {loss['lossy_floor']:.3f}"
        if by_loss
        else (
            f"a floor that the contact time of {1e6 * found['contact_s']:.0f} us sets and that loss in the "
            "contact does not lower"
        )
    )
    return (
        f"In a first collision at excess {found['excess']:g} the higher modes leave mode 1 a restitution of "
        f"{found['restitution']:.3f}, and of {least['restitution']:.3f} at least, whatever the mass of the "
        f"ball: {floor}. On settled orbits, where the collision before still rings, it lies between "
        f"{min(settled):.2f} and {max(settled):.2f}. The delay is {MILLI * found['delay_s']:.3f} ms, "
        f"{found['delay_over_arc']:.2f} of the time in which the tip would turn by itself."
    )


def of_square_root(summary: Mapping[str, Any]) -> str:
    beam = summary["beam"]
    below = beam["resolution"] / beam["doubling_excess"]
    seen = f"{below:.0f} times below the letter's amplitude stability, which is why it was not seen"
    return (
        f"The square root holds from an excess of {beam['square_root_from']:.1e} on; half of the kick is "
        f"left at {beam['half_excess']:.1e}. Below, the Hertz contact smooths it, and the period doubling "
        f"that this brings ends at {beam['doubling_excess']:.1e}, "
        f"{seen if below > 1.0 else 'within what the letter could resolve'}."
    )


ANSWERS = (
    Answer(
        key="hysteresis",
        question="Why does the measured hysteresis differ from the map's?",
        parts=(Part(study="hysteresis", words=of_hysteresis, tables=lambda s: [causes(s)]),),
    ),
    Answer(
        key="modes",
        question="What do higher modes do to restitution, delay and the square root?",
        parts=(
            Part(study="effective_impact", words=of_collision, tables=lambda s: [reference(s)]),
            Part(study="soft_wall", words=of_square_root, tables=lambda s: [smoothing(s)]),
        ),
    ),
)


def told(part: Part, stored: Stored | None) -> tuple[str, list[Table]]:
    """Words and tables of a part, or one sentence that says what is missing."""
    if stored is None:
        return f"Not computed yet: python -m studies.{part.study}.", []
    said = asked(lambda: part.words(stored.summary))
    if said is None:
        return f"The stored summary of {part.study} does not hold this: python -m studies.{part.study}.", []
    return said, asked(lambda: part.tables(stored.summary)) or []
