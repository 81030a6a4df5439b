"""Columns of numbers as a CSV file, and as a table of pandas."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pandas import DataFrame


def write_csv(path: str | Path, columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> None:
    """Write one line for each row; the first line names the columns and their units."""
    lines = [",".join(f"{name} [{units[name]}]" for name in columns)]
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    lines += [",".join(map(str, row)) for row in rows]
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def dataframe(columns: Mapping[str, np.ndarray], units: Mapping[str, str]) -> DataFrame:
    """Return a pandas.DataFrame, whose ``attrs["units"]`` keeps the units.

    ImportError is raised if pandas is not installed.
    """
    try:
        from pandas import DataFrame  # slow to import, and often not installed
    except ImportError as error:
        words = "a DataFrame needs the package pandas: python -m pip install pandas"
        raise ImportError(f"{words}; to_csv writes the same columns without it") from error
    frame = DataFrame(dict(columns))
    frame.attrs["units"] = dict(units)
    return frame
