"""Records as laboratories write them: one motion in many files is read back to the same SI numbers."""

import gzip
import io
import re
import sys
import time

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from beam import InvalidValue
from studies.measurement.identify.record.reading import read_record
from studies.shell.tables.units import UNITS, split

N, STEP = 200, 1e-3
TIMES = STEP * np.arange(N)
MOTION = 0.01 * np.sin(2 * np.pi * 22.2 * TIMES) + 0.004 * np.cos(2 * np.pi * 61.0 * TIMES)  # [m]


def body(mark=",", size=1e3, start=0.0, each=1.0, decimal=".", form="{:.10g}", end="", values=True):
    """Lines of time and motion, in a unit of which there are `size` in a metre."""
    pairs = ((each * (t + start), size * x) for t, x in zip(TIMES, MOTION, strict=True))
    rows = [mark.join(form.format(one) for one in (pair if values else pair[1:])) + end for pair in pairs]
    return "\n".join(rows).replace(".", decimal) + "\n"


GERMAN = body(";", decimal=",")
LVM = (
    "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\t{}\n***End_of_Header***\t\n\t\n"
    "Channels\t1\t\nSamples\t200\t\nY_Unit_Label\tmm\t\nX_Dimension\tTime\t\nX0\t0,0E+0\t\nDelta_X\t0,001\t\n"
    "***End_of_Header***\t\t\nX_Value\tWeg\tComment\n"
)
POLYTEC = (
    "Source File Name:\tbeam.pvd\nPoint Index:\t1\nComponent:\tRoot\nSignal:\tVib Displacement\n\n"
    "Time\tDisplacement\n[ s ]\t[ mm ]\n"
)
CATMAN = "CATMAN-Export\nErstellt:\t28.11.2026\nZeit  1 - Standardmessrate\tWeg\ns\tµm\n"
TBS = "Model,TBS1052C\nSample Interval,1e-3,s\nRecord Length,200\nVertical Units,V,\n\nTIME,CH1\n"
RIGOL = "X,CH1,Start,Increment,\nSequence,Volt,-5.0e-02,1.0e-03,\n"
RIGOL += "\n".join(f"{i},{1e3 * x:.10g}," for i, x in enumerate(MOTION))
BESIDE = ["Record Length,200", "Sample Interval,1e-3", "Trigger Point,100", "Source,CH1", "Vertical Units,V"]
BESIDE += ["Horizontal Units,s", "Note,"]
TDS = "\n".join(f"{BESIDE[i] if i < 7 else ','},,{row}," for i, row in enumerate(body().splitlines()))
IMU = "# device: imu 3\n# sample_rate_hz = 1000\ncount,a_z\n"
IMU += "\n".join(f"{i + 7},{x:.10g}" for i, x in enumerate(MOTION))
ISO = "time,x (mm)\n" + "".join(
    f"2024-02-29T23:59:59.9{i:08d},{1e3 * x:.10g}\n"
    if False
    else f"2024-02-29T23:59:{59 + (900 + i) // 1000 - 0:02d}.{900 + i:03d},{1e3 * x:.10g}\n"
    for i, x in enumerate(MOTION[:100])
)
FIRST = "00:59:59.9"

SAME: dict[str, tuple[str, dict[str, object], str]] = {
    "plain": ("time_s,x_m\n" + body(size=1.0), {}, "x_m"),
    "blank after comma": ("time_s, x_m\n" + body(", ", 1.0), {}, "x_m"),
    "semicolons": ("time_s;x_m\n" + body(";", 1.0), {}, "x_m"),
    "decimal comma": ("time_s;x_m\n" + body(";", 1.0, decimal=","), {}, "x_m"),
    "tabs, CRLF": (("time_s\tx_mm\n" + body("\t")).replace("\n", "\r\n"), {}, "x_m"),
    "blanks": ("t x_mm\n" + body("   "), {}, "x_m"),
    "blanks, decimal comma": ("t x_mm\n" + body("   ", decimal=","), {}, "x_m"),
    "quoted": ('"time_s","x_m"\n' + body(size=1.0), {}, "x_m"),
    "comments": ("% by hand\n# time_s,x_m\n" + body(size=1.0), {}, "x_m"),
    "semicolon comment": ("; by hand\ntime_s,x_m\n" + body(size=1.0), {}, "x_m"),
    "no heading": (body(), {"unit": "mm"}, "x_m"),
    "a pandas index": (
        ",t [ms],x [mm]\n" + "".join(f"{i},{r}\n" for i, r in enumerate(body(each=1e3).split())),
        {},
        "x_m",
    ),
    "trailing commas": ("Time (s),Displacement (mm),\n" + body(end=","), {}, "x_m"),
    "blank lines": ("t,x (mm)\n\n" + body().replace("\n", "\n\n"), {}, "x_m"),
    "German": ("Zeit [s];Weg [mm]\n" + GERMAN, {}, "x_m"),
    "microseconds": ("t_us,x (µm)\n" + body(size=1e6, each=1e6), {}, "x_m"),
    "velocity": ("Zeit in ms;v in mm/s\n" + body(";", each=1e3), {}, "v_m_per_s"),
    "gravity": ("time,acc_g\n" + body(size=1 / 9.80665), {}, "a_m_per_s2"),
    "acceleration": ("time (s),acc (m/s^2)\n" + body(size=1.0), {}, "a_m_per_s2"),
    "one of three": (
        "t,x,y,z\n" + "".join(f"{r},1,2\n" for r in body().split()),
        {"columns": "t,x", "unit": "mm"},
        "x_m",
    ),
    "LabVIEW": (LVM.format("One") + body("\t", decimal=",", end="\t"), {}, "x_m"),
    "LabVIEW without times": (
        LVM.format("No") + "".join(f"\t{1e3 * x:.10g}\t\n" for x in MOTION).replace(".", ","),
        {},
        "x_m",
    ),
    "Polytec": (POLYTEC + body("\t"), {}, "x_m"),
    "catman": (CATMAN + body("\t", 1e6, decimal=","), {}, "x_m"),
    "LMS": ("Linear\tReal\nTime\tPoint 1\ns\tm/s^2\n" + body("\t", 1.0, form="{:.12E}"), {}, "a_m_per_s2"),
    "Tektronix TBS": (TBS + body(), {"unit": "V=1e-3 m"}, "x_m"),
    "Tektronix TDS": (TDS, {"unit": "V=1e-3m"}, "x_m"),
    "Keysight": ("x-axis,1\nsecond,Volt\n" + body(form="{:+.12E}"), {"unit": "V=1e-3 m"}, "x_m"),
    "Rigol": (RIGOL, {"unit": "V=1e-3 m"}, "x_m"),
    "phyphox": ('"Time (s)","Acceleration x (m/s^2)"\n' + body(size=1.0, form="{:.12E}"), {}, "a_m_per_s2"),
    "phyphox, German": (
        '"Time (s)";"Acceleration x (m/s^2)"\n' + body(";", 1.0, decimal=",", form="{:.12E}"),
        {},
        "a_m_per_s2",
    ),
    "IMU": (IMU, {"unit": "m/s^2"}, "a_m_per_s2"),
    "Arduino": ("millis,raw\n" + body(each=1e3), {"unit": "1=1e-3 m"}, "x_m"),
    "a channel alone": ("x_mm\n" + body(values=False), {"rate": 1000.0}, "x_m"),
    "stamps": (
        "time,x (mm)\n"
        + "".join(f"2024-02-29 23:59:59.{i:03d}000001,{1e3 * x:.10g}\n" for i, x in enumerate(MOTION)),
        {},
        "x_m",
    ),
    "times of day": (
        "Uhrzeit;Weg/mm\n"
        + "".join(f"9:59:59,{i:03d};{1e3 * x:.10g}\n" for i, x in enumerate(MOTION)).replace(".", ","),
        {},
        "x_m",
    ),
    "unix time": ("time_s,x_m\n" + body(size=1.0, start=1.7e9, form="{:.16g}"), {}, "x_m"),
}


def same(record, column="x_m", rel=1e-8):
    """The motion has come back."""
    assert record.columns == ("time_s", column)
    assert record.rows[:, 0] - record.rows[0, 0] == pytest.approx(TIMES, abs=3e-7 if record.origin else 1e-9)
    assert record.rows[:, 1] == pytest.approx(MOTION, abs=rel)


@pytest.mark.parametrize("name", SAME)
def test_one_motion_in_many_files(tmp_path, name):
    text, options, column = SAME[name]
    (tmp_path / "a.csv").write_text(text, newline="")
    record = read_record(tmp_path / "a.csv", **options)
    same(record, column)
    assert bool(record.reading) == (record.reading.find("read as") == 0) and not record.notes


if __name__ == "__main__":
    pass
