"""Three-dimensional pictures without a window, where the machine can draw them.

Without the libraries of OpenGL, rendering ends in a segmentation fault that no program can catch. Whether it
works is therefore tried once, in a process of its own; where it does not, studies say so in one sentence and
let matplotlib draw.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache

NEEDED = "libegl1 libegl-mesa0 libgl1-mesa-dri"
"""Debian packages that bring rendering in software."""

SENTENCE = (
    "matplotlib draws what is seen in space: off-screen rendering does not work here "
    f"(on Debian it needs {NEEDED})"
)

TRIAL = (
    "import pyvista; plotter = pyvista.Plotter(off_screen=True, window_size=(32, 32)); "
    "plotter.add_mesh(pyvista.Sphere()); "
    "raise SystemExit(int(plotter.screenshot(return_img=True).std() == 0.0))"
)

PATIENCE = 120.0
"""Seconds for the trial: importing pyvista from a cold disk takes half a minute at worst."""


def prepare_off_screen() -> None:
    """Set what VTK has to know before it is imported."""
    os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
    if not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


@cache
def can_render() -> bool:
    """Whether a picture could be drawn without a window; tried once."""
    prepare_off_screen()
    try:
        trial = subprocess.run(
            [sys.executable, "-c", TRIAL], capture_output=True, timeout=PATIENCE, check=False
        )
    except (OSError, subprocess.SubprocessError):
        return False
    return trial.returncode == 0
