"""`read_table`: a file by its first bytes. Text goes to `text`; recorders' binary files are read by SciPy,
pyuff and nptdms; what is no table is refused with what it is and what to give instead."""

import gzip
import importlib
import io
import re
import tempfile
import warnings
import zlib
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType

import numpy as np

from beam import InvalidValue
from studies.shell.programs import needs
from studies.shell.tables.text import Array, Table, read_text
from studies.shell.tables.units import split

Channels = Mapping[str, tuple[Array, str]]  # name -> values, unit

REFUSED = {
    b"\x89PNG": "a PNG picture: give the numbers behind it as CSV",
    b"\xff\xd8\xff": "a JPEG picture: give the numbers behind it as CSV",
    b"%PDF": "a PDF document: give the numbers in it as CSV",
    b"\x93NUMPY": "a NumPy file: save it with numpy.savetxt as CSV",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook: save its sheet as CSV",
    b"MATLAB 7.3": "a MATLAB file of version 7.3: save it with -v7",
    b"\x89HDF": "an HDF5 file: save it as CSV, from MATLAB with -v7",
    b"PK\x03\x04": "a zip archive: give one of the files in it",
}


def _table(channels: Channels, recognised: str, step: float | None = None, start: float = 0.0) -> Table:
    """The channels that are as long as the longest one."""
    longest = max((len(values) for values, _ in channels.values()), default=0)
    kept = {name: one for name, one in channels.items() if len(one[0]) == longest}
    if longest < 2:
        raise InvalidValue("it holds no vector of numbers")
    rows = np.column_stack([np.asarray(values, dtype=float) for values, _ in kept.values()])
    rows[~np.isfinite(rows)] = np.nan
    lines = np.arange(1, longest + 1)
    lost = {(int(i) + 1, int(k)): "nan" for i, k in np.argwhere(np.isnan(rows))[:1000]}
    units = tuple(unit or split(name)[1] for name, (_, unit) in kept.items())
    names = tuple(kept)
    return Table(
        names=names,
        units=units,
        rows=rows,
        recognised=recognised,
        lines=lines,
        lost=lost,
        step=step,
        start=start,
    )


def _wav(data: bytes) -> Table:
    from scipy.io import wavfile

    with warnings.catch_warnings():  # of chunks that are no samples
        warnings.simplefilter("ignore")
        rate, values = wavfile.read(io.BytesIO(data))
    values = values.reshape(len(values), -1)
    return _table({f"channel {i + 1}": (one, "") for i, one in enumerate(values.T)}, "WAV file", 1.0 / rate)


def _mat(data: bytes) -> Table:
    from scipy.io import loadmat

    found = {name: value for name, value in loadmat(io.BytesIO(data)).items() if name[:2] != "__"}
    arrays = {n: v for n, v in found.items() if v.ndim == 2 and np.issubdtype(v.dtype, np.number)}
    rates = [
        float(v.flat[0])
        for n, v in arrays.items()
        if v.size == 1 and re.match(r"fs|(sample_?)?rate", n, re.I)
    ]
    channels = dict[str, tuple[Array, str]]()
    for name, array in arrays.items():
        vectors = array if len(array) < array.shape[1] else array.T
        channels |= {f"{name} {i + 1}" if i else name: (one, "") for i, one in enumerate(vectors)}
    return _table(channels, "MATLAB file", 1.0 / rates[0] if rates and rates[0] > 0.0 else None)


def _uff(data: bytes) -> Table:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.uff"
        path.write_bytes(data)
        sets = _package("pyuff", needs("a universal file", "pyuff")).UFF(str(path)).read_sets()
    sets = [one for one in (sets if isinstance(sets, list) else [sets]) if one.get("type") == 58]
    named = {str(one.get("id1", "")).strip() or f"channel {i + 1}": one for i, one in enumerate(sets)}
    channels = {
        n: (one["data"], str(one.get("ordinate_axis_units_lab", "")).strip()) for n, one in named.items()
    }
    times = np.asarray(sets[0]["x"], dtype=float) if sets else np.zeros(0)
    return _table({"time": (times, "s"), **channels}, "universal file, data set 58")


def _tdms(data: bytes) -> Table:
    tdms = _package("nptdms", needs("a TDMS file", "npTDMS")).TdmsFile.read(io.BytesIO(data))
    found = {one.name: one for group in tdms.groups() for one in group.channels()}
    channels = {name: (one[:], str(one.properties.get("unit_string", ""))) for name, one in found.items()}
    about: Mapping[str, float] = next(
        (one.properties for one in found.values() if "wf_increment" in one.properties), {}
    )
    return _table(channels, "TDMS file", about.get("wf_increment"), float(about.get("wf_start_offset", 0.0)))


def _package(name: str, missing: str) -> ModuleType:
    """A package of the extra `records`."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise InvalidValue(f"{missing} (the extra records)") from error


READERS: Mapping[bytes, Callable[[bytes], Table]] = {
    b"RIFF": _wav, b"MATLAB 5": _mat, b"TDSm": _tdms, b"-1\n58": _uff
}  # fmt: skip


def _decoded(data: bytes, path: Path) -> tuple[str, str]:
    """The text in a file, and its encoding where it is not UTF-8."""
    even, odd = data[:2000:2].count(0), data[1:2000:2].count(0)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", "replace"), "UTF-16"
    if max(even, odd) > 0.8 * len(data[:2000:2]):
        return data.decode("utf-16-le" if odd > even else "utf-16-be", "replace"), "UTF-16"
    if b"\0" in data[:4000]:
        first = data[:8].hex(" ")
        raise InvalidValue(
            f"the record {path} is a binary file that begins with {first}; give CSV, WAV or .mat"
        )
    try:
        return data.decode("utf-8-sig"), ""
    except UnicodeDecodeError:
        return data.decode("latin-1"), "Latin-1"


def read_table(path: Path) -> Table:
    """The table in a file; InvalidValue with one sentence if there is none."""
    try:
        data = path.read_bytes()
        if data[:2] == b"\x1f\x8b":
            data = gzip.decompress(data)
    except (OSError, EOFError, zlib.error, ValueError) as error:
        raise InvalidValue(
            f"the record {path} cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from error
    for begin, words in REFUSED.items():
        if data.startswith(begin):
            words = "an Excel workbook: save its sheet as CSV" if b"xl/" in data[:4000] else words
            raise InvalidValue(f"the record {path} is {words}")
    begin = re.sub(rb"\s+", b"\n", data[:200].strip()) if data[:20].split()[:1] == [b"-1"] else data[:20]
    for first, reader in READERS.items():
        if begin.startswith(first):
            try:
                return reader(data)
            except InvalidValue as error:
                raise InvalidValue(f"the record {path}: {error}") from error
            except Exception as error:  # of a reader: a file cut short, or damaged
                reason = str(error)[:80] or type(error).__name__
                raise InvalidValue(f"the record {path} is damaged: {reason}") from error
    return read_text(*_decoded(data, path), path)
