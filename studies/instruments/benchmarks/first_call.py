"""What a first run costs: the time until a fresh interpreter has its first collision, and its memory."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from statistics import median

__all__ = ["first_call"]

ROOT = Path(__file__).resolve().parents[3]

PROGRAM = """
import json, resource, time
began = time.perf_counter()
from studies.instruments.oscillators import beam_of
from studies.instruments.scene_file import read_scene
from studies.instruments.spring_of_scene import model_of
from contact.collision import first_collision
imported = time.perf_counter()
scene = read_scene()
model = model_of(scene)
solved = time.perf_counter()
first_collision(beam_of(scene, 21.5, model).with_excess(0.013))
done = time.perf_counter()
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps([imported - began, solved - imported, done - solved, peak]))
"""


def first_call(repeats: int = 3) -> dict[str, float]:
    """Seconds for imports, modes and first collision with kernels that are kept, and the peak memory [MB]."""
    runs = []
    for _ in range(repeats):
        answer = subprocess.run(
            [sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=True
        )
        runs.append(json.loads(answer.stdout))
    names = ("imports_s", "modes_s", "first_collision_s", "peak_memory_mb")
    return {name: median(run[i] for run in runs) for i, name in enumerate(names)}
