"""Every study in its small form on many scenes: `python tests/varied_scenes.py [--only WORDS] [--out DIR]`.

A study on a scene must end with exit code 0 or 3, or refuse it in one sentence; a traceback is a fault of the
program. `varied.csv` in the folder `--out` keeps the exit codes and last sentences; the same command goes on
from there. All of it takes about an hour on two cores.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from studies.shell.programs import studies

ROOT = Path(__file__).resolve().parent.parent
FIVE_HZ = """modal_data.frequencies_hz=[5.5,40.0,120.0] modal_data.decay_rates_per_s=[0.8,6.0,18.0]
    modal_data.tip_values=[7.0,4.5,3.0] modal_data.participation=[0.17,-0.09,0.05]
    modal_data.static_compliance_m_per_n=0 single_mode.free_period_s=0.1818 single_mode.decay_rate_per_s=0.8
    drive.frequencies_hz=[4.7,5.0]"""
FAST = """modal_data.frequencies_hz=[216.0,1500.0] modal_data.decay_rates_per_s=[30.0,200.0]
    modal_data.tip_values=[7.0,4.5] modal_data.participation=[0.17,-0.09] stop.gap_m=2e-4
    modal_data.static_compliance_m_per_n=0 single_mode.free_period_s=0.00463 single_mode.decay_rate_per_s=30
    drive.frequencies_hz=[184.0,200.0]"""
ONE_MODE = """modal_data.frequencies_hz=[24.51] modal_data.decay_rates_per_s=[3.56]
    modal_data.tip_values=[7.688] modal_data.participation=[0.1707] modal_data.static_compliance_m_per_n=0
    modal_data.tip_mass_kg=0"""
STIFF = "spring.thickness_m=0.0024 single_mode.free_period_s=0.0172 drive.frequencies_hz=[49.6,51.0,55.5]"
SOFT = "spring.thickness_m=0.0006 single_mode.free_period_s=0.114 drive.frequencies_hz=[7.5,8.0]"
UNDAMPED = "damping.kind=constant_ratio damping.ratio=0 single_mode.decay_rate_per_s=0"
PINNED = "spring.kind=straight_strip spring.end_support=pinned tip.arc_fraction=0.5"
SCENES: dict[str, tuple[str, str]] = {
    "letter": ("letter", ""),
    "tight_fold": ("tight_fold", ""),
    "steel_ruler": ("steel_ruler", ""),
    "measured_modes": ("measured_modes", ""),
    "stiff sheet": ("letter", STIFF),
    "soft sheet": ("letter", SOFT),
    "light ball": ("letter", "tip.mass_kg=0.0005"),
    "no ball": ("letter", "tip.mass_kg=0"),
    "one mode": ("measured_modes", ONE_MODE),
    "heavy ball": ("letter", "tip.mass_kg=0.012 drive.frequencies_hz=[18.5]"),
    "one mode kept": ("letter", "modes.count=1"),
    "30 modes": ("letter", "modes.count=30"),
    "5 Hz": ("measured_modes", FIVE_HZ),
    "200 Hz": ("measured_modes", FAST),
    "Newton's law": ("letter", "contact.law=newton"),
    "Newton's law with loss": ("letter", "contact.law=newton contact.local_restitution=0.3"),
    "linear contact": ("letter", "contact.law=linear"),
    "linear contact with dashpot": ("letter", "contact.law=linear contact.damping_ns_per_m=2"),
    "soft linear contact": ("letter", "contact.law=linear contact.stiffness_n_per_m=2e4"),
    "soft ball": ("letter", "tip.ball_young_modulus_pa=1e8 tip.ball_radius_m=0.001"),
    "undamped": ("letter", UNDAMPED),
    "well damped": ("steel_ruler", "damping.ratio=0.1 single_mode.decay_rate_per_s=10.9"),
    "pinned strip": ("letter", PINNED),
    "restitution 0.9": ("letter", "single_mode.restitution=0.9 drive.frequencies_hz=[23.4]"),
}
"""Scene that is delivered, and the keys that are changed in it."""


def run(name: str, scene: str, out: Path) -> list[str]:
    """Study, scene, exit code (or "traceback", or "too long" after 600 s), run time [s], last line."""
    given, keys = SCENES[scene]
    command = [sys.executable, "-m", "studies", name, "--quick", "--workers=1", f"--out={out / scene}"]
    command += ["--scene", given, *(word for key in keys.split() for word in ("--set", key))]
    begun = time.monotonic()
    try:
        ran = subprocess.run(command, cwd=ROOT, env=os.environ, capture_output=True, text=True, timeout=600)
        code, said = str(ran.returncode), ran.stderr
    except subprocess.TimeoutExpired:
        code, said = "too long", ""
    if "Traceback" in said:
        code = "traceback"
        (out / f"{name}, {scene}.txt").write_text(said)
    last = next((line for line in reversed(said.splitlines()) if line.strip()), "")
    return [name, scene, code, f"{time.monotonic() - begun:.0f}", last]


def main() -> None:
    """Run what is not in the table yet, two at a time; a line for each."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="text that 'study, scene' must contain")
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "varied-scenes")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    table = args.out / "varied.csv"
    done = {tuple(row[:2]) for row in csv.reader(table.open())} if table.exists() else set()
    wanted = [(name, scene) for scene in SCENES for name in studies() if args.only in f"{name}, {scene}"]
    with ThreadPoolExecutor(2) as pool, table.open("a", newline="") as stream:
        for row in pool.map(lambda one: run(*one, args.out), [one for one in wanted if one not in done]):
            csv.writer(stream).writerow(row)
            stream.flush()
            print(", ".join(row), flush=True)
    rows = list(csv.reader(table.open()))
    print(f"{len(rows)} runs, {sum(row[2] not in ('0', '2', '3') for row in rows)} faults")


if __name__ == "__main__":
    main()
