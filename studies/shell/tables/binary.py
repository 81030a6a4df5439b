"""`read_table`: a file by its first bytes. Text goes to `text`, binary files of recorders to SciPy, pyuff and
nptdms. What is no table is refused with what it is and what to give instead."""

import gzip
import io
import re
import tempfile
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from scipy.io import loadmat, wavfile

from beam import InvalidValue
from studies.shell.programs import needs
from studies.shell.tables.text import Array, Table, read_text
from studies.shell.tables.units import split

Channels = dict[str, tuple[Array, str]]  # name -> values, unit

REFUSED = {
    rb"\x89PNG": "a PNG picture: give the numbers behind it as CSV",
    rb"%PDF": "a PDF document: give the numbers in it as CSV",
    rb"\xd0\xcf\x11\xe0|PK\x03\x04(?s:.{0,4000})xl/": "an Excel workbook: save its sheet as CSV",
    rb"PK\x03\x04": "a zip archive or an Excel workbook: give the file in it, or save its sheet as CSV",
    rb"MATLAB 7\.3|\x89HDF": "an HDF5 file: from MATLAB, save it with -v7, else as CSV",
}


def _table(channels: Channels, recognised: str, step: float | None = None, start: float = 0.0) -> Table:
    """The channels that are as long as the longest one."""
    longest = max((len(values) for values, _ in channels.values()), default=0)
    if longest < 2:
        raise InvalidValue("holds no vector of numbers")
    kept = {name: one for name, one in channels.items() if len(one[0]) == longest}
    rows = np.array([values for values, _ in kept.values()], dtype=float).T
    rows[~np.isfinite(rows)] = np.nan
    units = tuple(unit or split(name)[1] for name, (_, unit) in kept.items())
    lines, places = np.arange(1, longest + 1), tuple(range(len(kept)))
    return Table(tuple(kept), units, rows, lines, recognised, places, step=step, start=start)


def _wav(data: bytes) -> Table:
    with warnings.catch_warnings(action="ignore"):  # there are chunks that are no samples
        warnings.filterwarnings("error", message="Reached EOF")
        rate, values = wavfile.read(io.BytesIO(data))
    if values.dtype.kind in "iu":  # full scale is 1, as in a file of floats
        half = 2.0 ** (8 * values.dtype.itemsize - 1)
        values = values / half - (values.dtype.kind == "u")
    channels = enumerate(values.reshape(len(values), -1).T, 1)
    return _table({f"channel {i}": (one, "") for i, one in channels}, "WAV file", 1.0 / rate)


def _mat(data: bytes) -> Table:
    step, channels = None, Channels()
    for name, array in loadmat(io.BytesIO(data)).items():
        if name.startswith("__") or array.ndim != 2 or not np.issubdtype(array.dtype, np.number):
            continue
        if array.size == 1 and array[0, 0] > 0.0 and re.match(r"fs|(sample_?)?rate", name, re.I):
            step = step or 1.0 / float(array[0, 0])
        vectors = array if len(array) < array.shape[1] else array.T
        for i, one in enumerate(vectors, 1):
            channels[f"{name} {i}" if i > 1 else name] = one, split(name)[1]
    return _table(channels, "MATLAB file", step)


def _uff(data: bytes) -> Table:
    from pyuff import UFF

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.uff"
        path.write_bytes(data)
        sets = np.atleast_1d(UFF(str(path)).read_sets())
    channels = Channels()
    for i, one in enumerate([one for one in sets if one["type"] == 58], 1):
        channels.setdefault("time", (one["x"], "s"))
        channels[one["id1"].strip() or f"channel {i}"] = one["data"], one["ordinate_axis_units_lab"].strip()
    return _table(channels, "universal file, data set 58")


def _tdms(data: bytes) -> Table:
    from nptdms import TdmsFile

    groups = TdmsFile.read(io.BytesIO(data)).groups()
    found = {one.name: one for group in groups for one in group.channels()}
    channels = {name: (one[:], str(one.properties.get("unit_string", ""))) for name, one in found.items()}
    about: dict[str, float] = next(
        (one.properties for one in found.values() if "wf_increment" in one.properties), {}
    )
    return _table(channels, "TDMS file", about.get("wf_increment"), float(about.get("wf_start_offset", 0.0)))


MISSING = {"pyuff": needs("a universal file", "pyuff"), "nptdms": needs("a TDMS file", "npTDMS")}
READERS: Mapping[bytes, Callable[[bytes], Table]] = {
    rb"\x1f\x8b": lambda data: _content(gzip.decompress(data)),
    rb"RIFF": _wav,
    rb"MATLAB 5": _mat,
    rb"TDSm": _tdms,
    rb"\s*-1\s*\n\s*(58|151|164)": _uff,
}


def _decoded(data: bytes) -> tuple[str, str]:
    """The text in a file, and its encoding where it is not UTF-8."""
    even, odd = data[:2000:2].count(0), data[1:2000:2].count(0)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or max(even, odd) > 0.8 * len(data[:2000:2]):
        return data.decode("utf-16-le" if odd > even else "utf-16-be", "replace").lstrip("\ufeff"), "UTF-16"
    if b"\0" in data[:4000]:
        first = data[:8].hex(" ")
        raise InvalidValue(f"is a binary file that begins with {first}; give CSV, WAV or .mat")
    try:
        return data.decode("utf-8-sig"), ""
    except UnicodeDecodeError:
        return data.decode("latin-1"), "Latin-1"


def _content(data: bytes) -> Table:
    """The table in the bytes of a file; InvalidValue with what is wrong with it."""
    for begin, words in REFUSED.items():
        if re.match(begin, data):
            raise InvalidValue(f"is {words}")
    reader = next((reader for begin, reader in READERS.items() if re.match(begin, data)), None)
    if reader is None:
        return read_text(*_decoded(data))
    try:
        return reader(data)
    except InvalidValue:
        raise
    except ImportError as error:
        raise InvalidValue(f"cannot be read: {MISSING[error.name or '']} (the extra records)") from error
    except Exception as error:  # of a package: the file is cut short, or damaged
        raise InvalidValue(f"is damaged: {str(error)[:80] or type(error).__name__}") from error


def read_table(path: Path) -> Table:
    """The table in a file; InvalidValue with one sentence if there is none."""
    try:
        return _content(path.read_bytes())
    except OSError as error:
        raise InvalidValue(f"the record {path} cannot be read: {error.strerror}") from error
    except InvalidValue as error:
        raise InvalidValue(f"the record {path} {error}") from error
