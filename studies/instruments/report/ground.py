"""The ground that the results stand on: scene with provenance, runs, versions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from studies.instruments.progress import duration
from studies.instruments.report import assumed
from studies.instruments.report.digits import words
from studies.instruments.report.markup import Column, Table, code, escaped, prose
from studies.instruments.report.stored import Stored


def settings(results: Sequence[Stored]) -> str:
    if not results:
        return ""
    found = assumed.tables(results[0])
    said = (
        f"The scene of {results[0].study}, in SI units. The letter prints no thickness, width, bend radius, "
        "ball mass, gap or overtone; what depends on them is marked in every summary. Modes and mesh are "
        "chosen for what each study asks."
    )
    return (
        f'<section id="assumed"><h2>What was assumed</h2><p>{prose(said)}</p>'
        + "".join(table.html() for table in found)
        + "</section>"
    )


def runs(results: Sequence[Stored]) -> str:
    """Versions and runs."""
    manifests = [stored.manifest for stored in results]
    table = Table(
        caption="Runs.",
        columns=[
            Column(head="study", values=[stored.study for stored in results], write=code, numeric=False),
            Column(
                head="command",
                values=[manifest.get("command", "") for manifest in manifests],
                numeric=False,
                write=lambda command: f"<code>{escaped(command)}</code>",
            ),
            Column(
                head="begun (UTC)",
                values=[str(m.get("begun", ""))[:16] for m in manifests],
                write=lambda moment: escaped(moment.replace("T", " ")),
            ),
            Column(
                head="took",
                values=[m.get("wall_time_s") for m in manifests],
                write=lambda seconds: duration(seconds) if isinstance(seconds, int | float) else words(None),
            ),
            Column(
                head="commit",
                values=[(stored.commit or "")[:8] for stored in results],
                write=code,
                numeric=False,
            ),
            Column(head="status", values=[m.get("status") for m in manifests], write=words, numeric=False),
        ],
    )
    return (
        '<section id="runs"><h2>Versions and run times</h2>'
        + (table.html() if results else "")
        + versions(results)
        + "</section>"
    )


def versions(results: Sequence[Stored]) -> str:
    """One column for each set of versions that occurs."""
    sets: list[Mapping[str, Any]] = []
    for stored in results:
        found = stored.part("versions")
        if found and found not in sets:
            sets.append(found)
    if not sets:
        return ""
    names = list(dict.fromkeys(name for found in sets for name in found))
    heads = ["version"] if len(sets) == 1 else [f"set {number + 1}" for number in range(len(sets))]
    columns = [
        Column(head=head, values=[found.get(name) for name in names], write=words, numeric=False)
        for head, found in zip(heads, sets, strict=True)
    ]
    first = Column(head="package", values=names, write=escaped, numeric=False)
    return Table(caption="Versions.", columns=[first, *columns]).html()
