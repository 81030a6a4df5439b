"""Records as laboratories write them: one motion in many files is read back to the same SI numbers."""

import gzip
import io
import re
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from beam import InvalidValue
from studies.measurement.identify.__main__ import in_frame
from studies.measurement.identify.record.reading import read_record
from studies.measurement.identify.record.records import Record

N, STEP = 200, 1e-3
TIMES = STEP * np.arange(N)
MOTION = 0.01 * np.sin(2 * np.pi * 22.2 * TIMES) + 0.004 * np.cos(2 * np.pi * 61.0 * TIMES)  # [m]


def body(mark=",", size=1e3, start=0.0, each=1.0, decimal=".", form="{:.10g}", end=""):
    """Lines of time and motion, in units of which there are `each` in a second and `size` in a metre."""
    pairs = ((each * (t + start), size * x) for t, x in zip(TIMES, MOTION, strict=True))
    rows = [mark.join(form.format(one) for one in pair) + end for pair in pairs]
    return "\n".join(rows).replace(".", decimal) + "\n"


def rows_of(line, decimal="."):
    """One line for each row i of the motion x in millimetres."""
    rows = (line.format(i=i, x=1e3 * x) for i, x in enumerate(MOTION))
    return "\n".join(rows).replace(".", decimal) + "\n"


def of(text, column="x_m", **options):
    """A file, the column that it is, and what the user has to say."""
    return text, column, options


SI, LONG, VOLT = body(size=1.0), "{:.12E}", "V=1e-3 m"
LVM = (
    "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\t{}\n***End_of_Header***\t\n\t\n"
    "Channels\t1\t\nSamples\t200\t\nY_Unit_Label\tmm\t\nX_Dimension\tTime\t\nX0\t0,0E+0\t\nDelta_X\t0,001\t\n"
    "***End_of_Header***\t\t\nX_Value\tWeg\tComment\n"
)
POLYTEC = "Source File Name:\tbeam.pvd\nPoint Index:\t1\nComponent:\tRoot\nSignal:\tVib Displacement\n\n"
POLYTEC += "Time\tDisplacement\n[ s ]\t[ mm ]\n"
CATMAN = "CATMAN-Export\nErstellt:\t28.11.2026\nZeit  1 - Standardmessrate\tWeg\ns\tµm\n"
CATMAN += body("\t", 1e6, decimal=",")
TBS = "Model,TBS1052C\nSample Interval,1e-3,s\nRecord Length,200\nVertical Units,V,\n\nTIME,CH1\n"
RIGOL = "X,CH1,Start,Increment,\nSequence,Volt,-5.0e-02,1.0e-03,\n" + rows_of("{i},{x:.10g},")
BESIDE = "Record Length,200 Sample Interval,1e-3 Trigger Point,100 Source,CH1 Vertical Units,V Note,"
BESIDE = re.findall(r"\S[^,]*,\S*", BESIDE) + [","] * N
TDS = "".join(f"{words},,{row},\n" for words, row in zip(BESIDE, body().split(), strict=False))
IMU = "# device: imu 3\n# sample_rate_hz = 1000\ncount,a_z\n" + rows_of("{i},{x:.10g}")
GERMAN = "Zeit [s];Weg [mm]\n" + body(";", decimal=",")
THREE = "t,x (mm),y (mm),z (mm)\n" + body(end=",1,2")
SAME = {
    "plain": of("time_s,x_m\n" + SI),
    "blank after comma": of("time_s, x_m\n" + body(", ", 1.0)),
    "decimal comma": of("time_s;x_m\n" + body(";", 1.0, decimal=",")),
    "tabs, CRLF": of(("time_s\tx_mm\n" + body("\t")).replace("\n", "\r\n")),
    "blanks, decimal comma": of("t x_mm\n" + body("   ", decimal=",")),
    "comments": of("% by hand\n# time_s,x_m\n" + SI),
    "semicolon comment": of("; by hand\ntime_s,x_m\n" + SI),
    "no heading": of(body(), unit="mm"),
    "a pandas index": of(",t [ms],x [mm]\n" + rows_of("{i},{i},{x:.10g}")),
    "a pandas index, semicolons": of(";t [ms];x [mm]\n" + rows_of("{i};{i};{x:.10g}")),
    "trailing commas": of("Time (s),Displacement (mm),\n" + body(end=",")),
    "blank lines": of("t,x (mm)\n\n" + body().replace("\n", "\n\n")),
    "German": of(GERMAN),
    "microseconds": of("t_us,x (µm)\n" + body(size=1e6, each=1e6)),
    "velocity": of("Zeit in ms;v in mm/s\n" + body(";", each=1e3), "v_m_per_s"),
    "gravity": of("time,acc_g\n" + body(size=1 / 9.80665), "a_m_per_s2"),
    "one of three": of(THREE, columns="t,x"),
    "LabVIEW": of(LVM.format("One") + body("\t", decimal=",", end="\t")),
    "LabVIEW without times": of(LVM.format("No") + rows_of("\t{x:.10g}\t", ",")),
    "Polytec": of(POLYTEC + body("\t")),
    "catman": of(CATMAN),
    "LMS": of("Linear\tReal\nTime\tPoint 1\ns\tm/s^2\n" + body("\t", 1.0, form=LONG), "a_m_per_s2"),
    "Tektronix TBS": of(TBS + body(), unit=VOLT),
    "Tektronix TDS": of(TDS, unit="V=1e-3m"),
    "Keysight": of("x-axis,1\nsecond,Volt\n" + body(form="{:+.12E}"), unit=VOLT),
    "Rigol": of(RIGOL, unit=VOLT),
    "phyphox": of('"Time (s)","Acceleration x (m/s^2)"\n' + body(size=1.0, form=LONG), "a_m_per_s2"),
    "IMU": of(IMU, "a_m_per_s2", unit="mm/s^2"),
    "Arduino": of("millis,raw\n" + body(each=1e3), unit="1=1e-3 m"),
    "a channel alone": of("x_mm\n" + rows_of("{x:.10g}"), rate=1000.0),
    "stamps": of("time,x (mm)\n" + rows_of("2024-02-29 23:59:59.{i:03d}000001,{x:.10g}")),
    "times of day": of("Uhrzeit;Weg/mm\n" + rows_of("9:59:59,{i:03d};{x:.10g}", ",")),
    "unix time": of("time_s,x_m\n" + body(size=1.0, start=1.7e9, form="{:.16g}")),
    "another unit than the file's": of("t,v (m/s)\n" + body(), unit="mm"),
}


def same(record, column="x_m", within=1e-10):
    """The motion has come back."""
    assert record.columns == ("time_s", column) and not record.notes
    assert record.rows[:, 0] - record.rows[0, 0] == pytest.approx(TIMES, abs=3e-7 if record.origin else 1e-9)
    assert record.rows[:, 1] == pytest.approx(MOTION, abs=within)


def read(folder, content, **options):
    (folder / "a.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_record(folder / "a.csv", **options)


@pytest.mark.parametrize("name", SAME)
def test_one_motion_comes_back_from_many_files(tmp_path, name):
    text, column, options = SAME[name]
    record = read(tmp_path, text, **options)
    same(record, column)
    plain = re.search(r"time_s\W+x_m\W", text) is not None
    assert plain != bool(re.fullmatch("read as .* 200 rows at 1000 Hz", record.reading))
    assert (" in mm (the file says m/s) over " in record.reading) == ("file's" in name)


ROWS = body().splitlines()


def changed(line, *rows):
    """A table with other rows in this line of the file."""
    return "\n".join(["t,x_mm", *ROWS[: line - 2], *rows, *ROWS[line - 1 :]]) + "\n"


LOST = {
    changed(101, f"0.099,{word}"): (199, f"1 of 200 .* line 101, '{word}'") for word in ("", "NaN", "inf")
}
LOST |= {
    changed(2, "0,OVERLOAD"): (199, "1 of 200 rows hold no number and .* the first is line 2, 'OVERLOAD'"),
    changed(2, ",0.3"): (199, "line 2, ''"),
    changed(201, ROWS[-1], "end of record", "200 rows"): (200, "2 of 202 .* line 202, 'end of record'"),
    changed(3, "t,x_mm", ROWS[1]): (200, "1 of 201 .* line 3, 't'"),
    changed(101, ROWS[99], ROWS[99]): (200, "1 of 201 rows repeat the time .* line 102"),
}


@pytest.mark.parametrize("text", LOST, ids=range(len(LOST)))
def test_a_row_without_a_number_is_left_out_and_counted(tmp_path, text):
    n, said = LOST[text]
    record = read(tmp_path, text)
    places = np.rint(record.rows[:, 0] / STEP).astype(int)
    assert len(record.rows) == n and record.rows[:, 1] == pytest.approx(MOTION[places], abs=1e-10)
    assert len(record.notes) == 1 and re.search(said, record.notes[0])


def test_rounded_stamps_midnight_and_columns_that_hold_words(tmp_path):
    """Columns have the numbers that they have in the file; a rate replaces its times."""
    rounded = [f"{round(0.64 * i):d},{1e3 * x:.9g}" for i, x in enumerate(MOTION)]
    record = read(tmp_path, "millis,x_mm\n" + "\n".join(rounded))
    assert np.diff(record.rows[:, 0]) == pytest.approx(6.4e-4, rel=1e-3) and len(record.rows) == 200
    assert re.search(
        "stamps are multiples of 0.001 s: rows are taken as evenly spaced by 0.00063995", record.notes[0]
    )
    late = [
        f"{'23:59:59' if i < 100 else '00:00:00'}.{(900 + i) % 1000:03d},{1e3 * x:.9g}"
        for i, x in enumerate(MOTION)
    ]
    same(read(tmp_path, "time,x_mm\n" + "\n".join(late)))
    noted = [row.replace(",", ",ok,") for row in ROWS]
    same(read(tmp_path, "t,note,x_mm\n" + "\n".join(noted), columns="1,3"))
    same(read(tmp_path, GERMAN.replace("Zeit [s]", "Zeit [ms]"), rate=1000.0))


def test_a_cell_of_a_wide_file_is_shown_however_many_were_lost_before(tmp_path):
    rows = (f"{row}{30 * (',1' if i % 2 else ',--')}\n" for i, row in enumerate(ROWS))
    text = "t,x_mm" + "".join(f",y{i}" for i in range(30)) + "\n" + "".join(rows)
    record = read(tmp_path, re.sub(r"(?<=\n0.15,)[^,]*", "OVER", text), columns="t,x_mm")
    assert record.notes == ("1 of 200 rows hold no number and are left out: the first is line 152, 'OVER'",)


IN_VOLT = "t,U (V)\n" + body()
HALF = [f"{row.split(',')[0]},OVER" if i % 2 or i > 190 else row for i, row in enumerate(ROWS)]
UNTIDY = [  # content, what the user says of it, the refusal
    (b"", {}, "is empty"),
    ("dear reader\nthis is a letter\n", {}, "its first lines are 'dear reader | this is a letter'; give"),
    (THREE, {}, r"3 channels, 'x \(mm\)', 'y \(mm\)', 'z \(mm\)': choose one, as in --columns 1,2"),
    ("t,x (mm),U (V)\n" + body(end=",1"), {}, "2 channels"),
    (THREE, {"columns": "t,w"}, "no column 'w'; it has 't', "),
    (THREE, {"columns": "1,2,3"}, "must be TIME,VALUE"),
    (THREE, {"columns": "2,3"}, "has the unit 'mm' for the time 'x'"),
    ("t\n" + rows_of("{i}"), {}, "no channel beside its time; its columns are 't'"),
    (IN_VOLT, {}, "the unit 'V' for the channel 'U .V.': give --unit V=5e-3 m"),
    *((IN_VOLT, {"unit": unit}, f"unit is '{unit}'; it must be") for unit in ("kN", "V=0 m", "V=1..5 m")),
    ("millis,raw\n" + body(), {}, "no unit for the channel 'raw': give --unit mm, .*--unit 1=5e-3 m"),
    (body(), {}, "no unit for the channel 'column 2'"),
    ("x (mm)\n" + rows_of("{x}"), {}, "has no time: give --rate HZ"),
    (IMU.replace("sample_rate_hz", "gain"), {"unit": "g"}, "only the count 'count' for a time: give --rate"),
    ("time (fortnight),x (mm)\n" + body(), {}, "the unit 'fortnight' for the time 'time'; it must be s, ms"),
    ("t,x_m,x_m\n" + body(end=",1"), {"columns": "t,x_m"}, r"several columns 'x_m': choose by number, \["),
    (IN_VOLT, {"unit": "mV=1mm"}, "has the unit 'V', but unit is 'mV=1mm'"),
    ("time,x (mm)\n" + rows_of("10:00:00,{x}"), {}, "199 of 200 rows that repeat .* give --rate HZ"),
    (IMU, {}, "no unit for the channel 'a_z'"),
    (changed(101, "0.05,1"), {}, "the time 0.05 s in line 101; times must rise"),
    ("\n".join(["t,x_mm", *HALF]), {}, "no number in 104 of 200 rows: the first is line 3, 'OVER'"),
    (changed(101, "0.099,1e300"), {}, r"x_m in row 100 of .* at most 1e\+06"),
    (b"\x89PNG\r\n", {}, "PNG picture: give the numbers"),
    (b"PK\x03\x04 xl/workbook.xml", {}, "Excel workbook: save its sheet as CSV"),
    (b"PK\x03\x04", {}, "zip archive"),
    (b"MATLAB 7.3 MAT-file", {}, "save it with -v7"),
    (bytes(range(50)), {}, "binary file that begins with 00 01 02"),
    (gzip.compress(IN_VOLT.encode())[:60], {}, "is damaged: Compressed file ended"),
]


@pytest.mark.parametrize("case", UNTIDY, ids=range(len(UNTIDY)))
def test_what_cannot_be_read_is_refused_in_a_sentence(tmp_path, case):
    content, options, said = case
    with pytest.raises(InvalidValue, match=said) as refusal:
        read(tmp_path, content, **options)
    assert "\n" not in str(refusal.value)


def written(writer, *values):
    file = io.BytesIO()
    writer(file, *values)
    return file.getvalue()


def test_binary_files_and_encodings(tmp_path):
    whole, single = np.rint(1e6 * MOTION).astype(np.int16), (50 * MOTION).astype("f4")
    same(read(tmp_path, written(wavfile.write, 1000, whole), unit=f"1={2**15}e-6 m"), within=1e-6)
    cut = written(wavfile.write, 1000, whole)[:200]
    with pytest.raises(InvalidValue, match="is damaged: Reached EOF"):
        read(tmp_path, cut, unit="mm")
    same(read(tmp_path, written(wavfile.write, 1000, single), unit="1=20 mm"), within=1e-9)
    same(read(tmp_path, written(savemat, {"t": TIMES, "x_m": MOTION})))
    same(read(tmp_path, written(savemat, {"fs": 1000.0, "x_mm": 1e3 * MOTION[:, None]})))
    same(read(tmp_path, gzip.compress(GERMAN.encode())))
    for encoding in ("utf-16", "utf-16-le", "latin-1", "utf-8-sig"):
        same(read(tmp_path, CATMAN.encode(encoding)))


def universal():
    """Units (data set 164), and a data set 58 of numbers at even steps."""
    axes = (17, "Time", "s"), (8, "Displacement", "mm"), (0, "NONE", "NONE"), (0, "NONE", "NONE")
    unit = [f"{1:10d}{'SI':20s}{2:10d}", 3 * f"{1.0:25.17e}", f"{0.0:25.17e}"]
    lines = ["    -1", "   164", *unit, "    -1", "    -1", "    58", "tip", *4 * ["NONE"]]
    lines += ["    1         0    0         0       NONE         1   3       NONE         1   1"]
    lines += [f"{4:10d}{N:10d}{1:10d}{0.0:13.5e}{STEP:13.5e}{0.0:13.5e}"]
    lines += [f"{kind:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}" for kind, name, unit in axes]
    lines += ["".join(f"{x:20.11e}" for x in row) for row in 1e3 * MOTION.reshape(-1, 4)]
    return "\n".join([*lines, "    -1", ""])


def test_universal_files_and_tdms(tmp_path):
    pytest.importorskip("pyuff")
    nptdms, file = pytest.importorskip("nptdms"), io.BytesIO()
    same(read(tmp_path, universal()))
    about = {"wf_increment": STEP, "wf_start_offset": 0.0, "unit_string": "mm"}
    with nptdms.TdmsWriter(file) as writer:
        writer.write_segment([nptdms.ChannelObject("group", "x", 1e3 * MOTION, properties=about)])
    same(read(tmp_path, file.getvalue()))


@pytest.mark.parametrize(("package", "content"), [("nptdms", b"TDSm"), ("pyuff", universal().encode())])
def test_a_missing_package_is_named(run_study, tmp_path, monkeypatch, package, content):
    monkeypatch.setitem(sys.modules, package, None)
    (tmp_path / "a").write_bytes(content)
    ran = run_study("identify", str(tmp_path / "a"))
    assert ran.code == 2 and re.search(f"needs {package}: python -m pip install", ran.err, re.I), ran.err


CHOSEN = [("x_m", None, "base"), ("v_m_per_s", None, "base"), ("a_m_per_s2", None, "ground")]
GIVEN = [("a_m_per_s2", "base", ""), ("v_m_per_s", "ground", "")]


@pytest.mark.parametrize(("column", "frame", "place"), [*CHOSEN, *GIVEN])
def test_what_a_reading_is_relative_to_is_chosen_by_its_kind_and_printed(column, frame, place):
    said, times = list[str](), np.arange(50.0)
    record = Record(columns=("time_s", column), rows=np.array([times, times]).T, reading="read")
    found = in_frame(record, frame, SimpleNamespace(say=said.append))
    assert found.ground == ((frame or place) == "ground")
    assert said[1:] == [one for one in said if one.startswith(f"taken as relative to the {place}; if not")]
    assert len(said) == 2 - bool(frame)
    with pytest.raises(InvalidValue, match="frame is base, but the record is no motion over time"):
        in_frame(replace(record, columns=("x_m",), rows=record.rows[:, :1]), "base", SimpleNamespace())


def test_a_long_record_is_read_soon(tmp_path):
    text = "t;x_mm\n" + "".join(f"{i / 2000};{i % 7}\n" for i in range(20_000)).replace(".", ",")
    begin = time.process_time()
    assert len(read(tmp_path, text).rows) == 20_000 and time.process_time() - begin < 1.0


def test_options_need_a_record_and_the_choice_is_printed(run_study, tmp_path):
    for name, value in (("columns", "1,2"), ("unit", "mm"), ("rate", "5")):
        ran = run_study("identify", f"--{name}", value)
        assert ran.code == 2 and "it needs a record" in ran.err
    (tmp_path / "a.csv").write_text(IN_VOLT)
    ran = run_study("identify", str(tmp_path / "a.csv"), "--unit", VOLT, "--fit", "gapp")
    assert "read as a table; commas: 'U' in V=1e-3 m over 't' in s, 200 rows at 1000 Hz" in ran.err
