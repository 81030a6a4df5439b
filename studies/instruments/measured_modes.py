"""Measured modes from a CSV file: the names of the lists of [modal_data], then one line per mode.

    frequencies_hz,decay_rates_per_s,tip_values,participation
    24.51,3.56,8.2,0.11
    149.0,21.6,6.9,0.06

Units are those of the keys: Hz, 1/s, kg^(-1/2), kg^(1/2). The columns may stand in any order; empty lines and
lines that begin with # are skipped.
"""

from __future__ import annotations

import csv
from pathlib import Path

from studies.instruments.quantities import SceneError, shown
from studies.instruments.scene import MODE_LISTS


def read_measured_modes(path: Path) -> dict[str, tuple[float, ...]]:
    """The four lists in a file, by their names in [modal_data]."""
    name = shown(str(path))
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not text in UTF-8"
        raise SceneError(f"modal_data.file {name} cannot be read: {reason}") from error
    wanted = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    try:
        rows = list(csv.reader(wanted, skipinitialspace=True))
    except csv.Error as error:
        raise SceneError(f"modal_data.file {name} is no table of comma-separated values: {error}") from error
    heading = [cell.strip() for cell in rows[0]] if rows else []
    if sorted(heading) != sorted(MODE_LISTS):
        names = ",".join(MODE_LISTS)
        raise SceneError(f"modal_data.file {name} must begin with the heading {names} (in any order)")
    columns: dict[str, list[float]] = {column: [] for column in heading}
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(heading):
            raise SceneError(
                f"modal_data.file {name} has {len(row)} values, not {len(heading)}, for mode {number}"
            )
        for column, cell in zip(heading, row, strict=True):
            try:
                columns[column].append(float(cell))
            except ValueError:
                raise SceneError(
                    f"modal_data.file {name} has {shown(cell)}, which is not a number, for {column} of mode "
                    f"{number}"
                ) from None
    return {column: tuple(values) for column, values in columns.items()}
