"""Mode shapes that can be turned in the page, where the extra `web` is installed.

The viewer is the offline page that trame-vtk brings; each mode is one scene for it, written by trame-vtk's
own serializers from modes.vtu: the strip at rest, translucent, and brass, tape and ball moved by the mode.
VTK is loaded in a process of its own, which nothing it does can take down with it:

    python -m studies.instruments.report.turnable results/modes/modes.vtu

prints {"viewer": html, "scenes": [{"name": ..., "data": base64}]}. The viewer names icons at an outside
address; they are taken out.
"""

from __future__ import annotations

import base64
import io
import json
import re
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from studies import ROOT
from studies.instruments.off_screen import prepare_off_screen

EXTRA = "the 3-D modes can be turned in the page where the extra `web` is installed: pip install -e '.[web]'"
FAILED = "the modes could not be prepared for turning in the page"
MOST_MODES = 8
PATIENCE = 60.0
"""Seconds for importing VTK from a cold disk and writing the scenes."""

COLOURS = ("#D8B24A", "#505050", "#F2F2F2")
"""Brass, tape, ceramic: by the cell array `part`."""

OUTSIDE = re.compile(r"https?://[\w.-]+/vtk-js/icon/")


@dataclass(frozen=True, kw_only=True)
class Turnable:
    """The viewer's page and its scenes: (name, base64)."""

    viewer: str
    scenes: tuple[tuple[str, str], ...]


def turnable(mesh: Path) -> Turnable | str:
    """The modes in a mesh, or the sentence that says why they cannot be turned."""
    if find_spec("trame_vtk") is None:
        return EXTRA
    command = [sys.executable, "-m", "studies.instruments.report.turnable", str(mesh.resolve())]
    try:
        answer = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
        found = json.loads(answer.stdout)
        scenes = tuple((scene["name"], scene["data"]) for scene in found["scenes"])
        return Turnable(viewer=found["viewer"], scenes=scenes) if scenes else FAILED
    except (OSError, subprocess.SubprocessError, ValueError, KeyError, TypeError):
        return FAILED


def _scene(grid: Any, vectors: str) -> bytes:
    """One mode as the archive that the viewer reads."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (without it a render window is abstract)
    from trame_vtk.modules.vtk.serializers import (
        SynchronizationContext,
        extract_array_hash,
        reference_id,
        serialize,
    )
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow

    window, renderer = vtkRenderWindow(), vtkRenderer()
    window.AddRenderer(renderer)
    renderer.SetBackground(1.0, 1.0, 1.0)
    for actor in _actors(grid, vectors):
        renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(0.25, -0.35, 0.30)
    camera.SetFocalPoint(0.07, 0.0, 0.0)
    camera.SetViewUp(0.0, 0.0, 1.0)
    renderer.ResetCamera()
    camera.Zoom(1.4)
    context = SynchronizationContext()
    context.set_ignore_last_dependencies(True)
    scene = serialize(None, window, reference_id(window), context, 1)
    scene["extra"] = {
        "vtkRefId": reference_id(window),
        "centerOfRotation": camera.GetFocalPoint(),
        "camera": reference_id(camera),
    }
    arrays = {
        entry["hash"]: {**entry, "content": context.get_cached_data_array(entry["hash"], False)}
        for entry in extract_array_hash(scene)
    }
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as pack:
        pack.writestr("index.json", json.dumps({"hashes": arrays, "scene": scene}))
    return archive.getvalue()


def _actors(grid: Any, vectors: str) -> list[Any]:
    """The strip at rest, translucent, and each part moved by the mode."""
    from vtkmodules.vtkFiltersGeneral import vtkWarpVector

    grid.GetPointData().SetActiveVectors(vectors)
    warp = vtkWarpVector()
    warp.SetInputData(grid)
    warp.Update()
    strip, tape, ball = range(len(COLOURS))
    actors = [_part(grid, strip, "#888888", opacity=0.15)]
    actors += [_part(warp.GetOutput(), part, COLOURS[part]) for part in (strip, tape, ball)]
    return [actor for actor in actors if actor is not None]


def _part(grid: Any, part: int, colour: str, opacity: float = 1.0) -> Any:
    from vtkmodules.vtkFiltersCore import vtkThreshold
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    chosen = vtkThreshold()
    chosen.SetInputData(grid)
    chosen.SetInputArrayToProcess(0, 0, 0, 1, "part")
    chosen.SetLowerThreshold(part - 0.5)
    chosen.SetUpperThreshold(part + 0.5)
    chosen.SetThresholdFunction(vtkThreshold.THRESHOLD_BETWEEN)
    surface = vtkGeometryFilter()
    surface.SetInputConnection(chosen.GetOutputPort())
    surface.Update()
    bare = surface.GetOutput()
    if not bare.GetNumberOfCells():
        return None
    for data in (bare.GetPointData(), bare.GetCellData(), bare.GetFieldData()):
        data.Initialize()
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(bare)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*(int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)))
    actor.GetProperty().SetOpacity(opacity)
    return actor


def main(argv: Sequence[str]) -> int:
    """Print viewer and scenes of the mesh named in `argv` as JSON."""
    prepare_off_screen()
    from trame_vtk.modules.vtk.serializers import initialize_serializers
    from trame_vtk.tools.vtksz2html import HTML_VIEWER_PATH
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    initialize_serializers()
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(argv[0])
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData()
    names = [data.GetArrayName(number) for number in range(data.GetNumberOfArrays())]
    names = sorted(name for name in names if name.startswith("mode_"))[:MOST_MODES]
    scenes = []
    for name in names:
        _, ordinal, frequency = name.split("_")
        scenes.append(
            {
                "name": f"mode {int(ordinal)}, {frequency.removesuffix('Hz')} Hz",
                "data": base64.b64encode(_scene(grid, name)).decode("ascii"),
            }
        )
    viewer = OUTSIDE.sub("data:,", Path(HTML_VIEWER_PATH).read_text(encoding="utf-8"))
    print(json.dumps({"viewer": viewer, "scenes": scenes}))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
