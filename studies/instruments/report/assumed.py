"""What the numbers rest on: every key of the scene with unit, value and where the value comes from.

Studies that were run with different scenes cannot be read side by side. Modes and mesh are chosen for what
each study asks (`needed`), and differ for that reason; any other difference is told.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from studies.instruments.quantities import ASSUMED, CALIBRATED, GIVEN, LETTER
from studies.instruments.report.digits import trimmed, words
from studies.instruments.report.markup import Column, Table, code, escaped
from studies.instruments.report.stored import Stored
from studies.instruments.scene import keys

NEEDED = "needed"
TITLES = {
    LETTER: "Printed in the letter",
    CALIBRATED: "Fitted to a number of the letter",
    GIVEN: "Set by the user",
    ASSUMED: "Assumed",
    NEEDED: "Chosen for what a study asks",
}
SHOWN = 3
"""Differences of scene that are named; further ones are counted."""


def _value(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(_value(item) for item in value) or "none"
    if isinstance(value, bool):
        return words(value)
    if isinstance(value, int | float):
        return str(value) if isinstance(value, int) and abs(value) < 10000 else trimmed(5)(value)
    return escaped(value) or "none"


def tables(base: Stored) -> list[Table]:
    """A table for each provenance that occurs, of the keys that matter for this scene."""
    parameters, provenance = base.parameters(), base.provenance()
    known = {key: entry for key, _kind, entry in keys()}
    measured = parameters.get("spring.kind") == "modal_data"
    found = []
    for origin, title in TITLES.items():
        names = [
            key
            for key, value in parameters.items()
            if provenance.get(key) == origin
            and key in known
            and (measured or not key.startswith("modal_data."))
            and value not in ("", [])
        ]
        if names:
            found.append(
                Table(
                    caption=f"{title}.",
                    columns=[
                        Column(head="key", values=names, write=code, numeric=False),
                        Column(head="value", values=[parameters[n] for n in names], write=_value),
                        Column(
                            head="unit",
                            values=[known[n].unit for n in names],
                            numeric=False,
                            write=lambda unit: "" if unit in ("", "1") else words(unit),
                        ),
                        Column(
                            head="meaning",
                            values=[known[n].meaning for n in names],
                            write=words,
                            numeric=False,
                        ),
                    ],
                )
            )
    return found


def differences(base: Stored, other: Stored) -> list[str]:
    """Keys in which another study's scene differs from the base's, as "key value instead of value"."""
    here, there = base.parameters(), other.parameters()
    chosen = {
        key for stored in (base, other) for key, origin in stored.provenance().items() if origin == NEEDED
    }
    return [
        f"{key} {there[key]} instead of {here[key]}"
        for key in here
        if key in there and key not in chosen and here[key] != there[key]
    ]


def _named(names: Sequence[str], stored: Sequence[Stored]) -> str:
    """These studies, or all but the others if that is shorter."""
    others = [study.study for study in stored if study.study not in names]
    if len(names) <= max(len(others), 1):
        return ", ".join(names)
    return f"all but {', '.join(others)}" if others else "all of them"


def warnings(stored: Sequence[Stored]) -> list[str]:
    """One sentence for each reason not to read the studies side by side."""
    if not stored:
        return []
    found, base = [], stored[0]
    for other in stored[1:]:
        changed = differences(base, other)
        if changed:
            more = f" and {len(changed) - SHOWN} more" if len(changed) > SHOWN else ""
            found.append(
                f"{other.study} was computed with another scene than {base.study}: "
                f"{', '.join(changed[:SHOWN])}{more}."
            )
    given = sorted({key for study in stored for key, origin in study.provenance().items() if origin == GIVEN})
    if given:
        more = f" and {len(given) - SHOWN} more" if len(given) > SHOWN else ""
        found.append(
            "Claims and captions speak of the default scene; here other values are given: "
            f"{', '.join(given[:SHOWN])}{more}."
        )
    quick = [study.study for study in stored if study.quick]
    if quick:
        found.append(f"Made with --quick, a small form with fewer points: {_named(quick, stored)}.")
    commits = {study.commit for study in stored}
    if len(commits) > 1:
        named = ", ".join(sorted(commit[:10] if commit else "none" for commit in commits))
        found.append(f"The studies were run at different commits: {named}.")
    loose = [study.study for study in stored if study.uncommitted]
    if loose:
        found.append(f"Run with changes that no commit holds: {_named(loose, stored)}.")
    releases = {
        tuple(sorted((name, str(number)) for name, number in study.part("versions").items()))
        for study in stored
    }
    if len(releases) > 1:
        found.append("The studies were run with different versions of Python or of packages, see below.")
    return found
