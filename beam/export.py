"""Mode shapes and motions as files for ParaView: .vtu meshes, and .pvd lists of them in time.

The mesh is the solid of `spring_mesh`. Its cell array `part` is 0 in the strip, 1 in glued layers and 2 on
the ball. Displacements are real vectors of three components [m], linear in the amplitude: drawn large, points
still move along straight lines.

Every file is written under a temporary name and then renamed, so that it is complete or absent. A .pvd lists
only existing frames, also if writing was interrupted. Writing needs pyvista but no graphics library.
"""

import math
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike

from .modes import Modes
from .parameters import require, require_array, require_whole
from .spring_mesh import solid_spring

LIST = """<?xml version="1.0"?>
<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">
  <Collection>
{}  </Collection>
</VTKFile>
"""


def mode_name(modes: Modes, mode: int) -> str:
    """Return the name of a mode's array, such as mode_01_24.51Hz; `mode` counts from 0."""
    return f"mode_{mode + 1:02d}_{modes.frequencies_hz[mode]:.2f}Hz"


def write_modes(
    path: Path,
    modes: Modes,
    *,
    decay_rates: ArrayLike | None = None,
    largest: float = 0.01,
    ball_radius: float | None = None,
) -> Path:
    """Write all mode shapes as vectors on one mesh, a .vtu file for ParaView.

    Parameters
    ----------
    path : Path
        Name of the file, ending in .vtu. Missing folders are made.
    modes : Modes
        Modes from `natural_modes`.
    decay_rates : array_like, shape (n_modes,), optional
        Decay rates to store with the modes [1/s].
    largest : float
        Largest displacement of each shape [m].
    ball_radius : float, optional
        Radius of the ball [m]; no ball without it.

    Returns
    -------
    Path
        The file. It has one point array for each mode, with a name such as ``mode_01_24.51Hz``. The field
        arrays are frequencies_hz, decay_rates_per_s if given, coupled (0 or 1), largest_displacement_m.

    Raises
    ------
    ValueError
        If `path` does not end in .vtu, a length is not positive, or `decay_rates` has another shape.
    TypeError
        If a length or a decay rate is not a number.

    See Also
    --------
    write_mode_motion : The motion in one mode, as a list of files in time.
    solid_spring : The mesh and the shapes on it, as arrays.
    natural_modes : The modes to write.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from beam import STEEL, StripSection, assemble, cantilever, natural_modes, write_modes
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> modes = natural_modes(assemble(cantilever(length=0.15, section=strip), elements=20), count=3)
    >>> with TemporaryDirectory() as folder:
    ...     file = write_modes(Path(folder) / "modes.vtu", modes, ball_radius=2e-3)
    ...     print(file.name, file.exists())
    modes.vtu True
    """
    require(path.suffix == ".vtu", "path", f"is {path}; its name must end in .vtu")
    mesh = solid_spring(modes, ball_radius=ball_radius)
    grid = mesh.grid()
    for mode, shape in enumerate(mesh.normalised(largest)):
        grid.point_data[mode_name(modes, mode)] = shape
    fields: dict[str, ArrayLike] = {"frequencies_hz": modes.frequencies_hz}
    if decay_rates is not None:
        shape = modes.omega.shape
        fields["decay_rates_per_s"] = require_array("decay_rates", decay_rates, "1/s", shape=shape)
    fields |= {"coupled": modes.coupled.astype(np.int8), "largest_displacement_m": [largest]}
    return _write_grid(path, grid, fields)


def write_mode_motion(
    path: Path,
    modes: Modes,
    mode: int,
    *,
    frames: int = 24,
    moved: bool = True,
    largest: float = 0.01,
    ball_radius: float | None = None,
) -> tuple[Path, ...]:
    """Write one undamped period of one mode, which repeats without a seam, as files for ParaView.

    A rigid motion, which has no period, is given one second.

    Parameters
    ----------
    path : Path
        Name of the list, ending in .pvd. Missing folders are made.
    modes : Modes
        Modes from `natural_modes`.
    mode : int
        Index of the mode, from 0.
    frames : int
        An even number, at least 2; an odd one would show one shape twice in the middle.
    moved : bool
        Whether the points themselves move. In any case the array `displacement` [m] is written, for
        ParaView's filter Warp By Vector.
    largest : float
        Largest displacement of the shape [m].
    ball_radius : float, optional
        Radius of the ball [m]; no ball without it.

    Returns
    -------
    tuple of Path, length frames + 1
        The .pvd file, then its frames.

    Raises
    ------
    ValueError
        If `path` does not end in .pvd, a length is not positive, `frames` is odd, or there is no such mode.
    TypeError
        If a length, `mode` or `frames` is not a number.

    See Also
    --------
    write_modes : All shapes in one file.
    write_frames : The same for any grids in time.
    natural_modes : The modes to write.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from beam import STEEL, StripSection, assemble, cantilever, natural_modes, write_mode_motion
    >>> strip = StripSection(material=STEEL, width=12e-3, thickness=0.5e-3)
    >>> modes = natural_modes(assemble(cantilever(length=0.15, section=strip), elements=20), count=3)
    >>> with TemporaryDirectory() as folder:
    ...     files = write_mode_motion(Path(folder) / "second.pvd", modes, 1, frames=4)
    ...     print(*[str(file.relative_to(folder)) for file in files[:2]], len(files))
    second.pvd second_frames/frame_0000.vtu 5
    """
    require_whole("mode", mode, "[1]", low=0, high=modes.omega.size - 1)
    require_whole("frames", frames, "[1]", low=2)
    require(frames % 2 == 0, "frames", f"is {frames} [1]; it must be an even number")
    mesh = solid_spring(modes, ball_radius=ball_radius)
    period = 2.0 * math.pi / float(modes.omega[mode]) if modes.omega[mode] > 0.0 else 1.0
    shape = mesh.normalised(largest)[mode]

    def grids() -> Iterator[tuple[float, Any]]:
        for number in range(frames):
            displacement = math.cos(2.0 * math.pi * number / frames) * shape
            grid = mesh.grid(mesh.points + displacement if moved else None)
            grid.point_data["displacement"] = displacement
            grid.field_data["frequency_hz"] = modes.frequencies_hz[mode : mode + 1]
            grid.field_data["largest_displacement_m"] = np.array([largest])
            yield period * number / frames, grid

    return write_frames(path, grids())


def write_frames(path: Path, frames: Iterable[tuple[float, Any]]) -> tuple[Path, ...]:
    """Write grids in time: NAME.pvd and NAME_frames/frame_0000.vtu and so on.

    Frames of an earlier and longer motion of the same name are removed.

    Parameters
    ----------
    path : Path
        Name of the list, ending in .pvd. Missing folders are made.
    frames : iterable of (float, pyvista.UnstructuredGrid)
        Times [s] and grids to write; each grid gets its time as the field array TimeValue.

    Returns
    -------
    tuple of Path
        The .pvd file, then its frames.

    Raises
    ------
    ValueError
        If `path` does not end in .pvd.
    """
    require(path.suffix == ".pvd", "path", f"is {path}; its name must end in .pvd")
    folder = path.with_name(f"{path.stem}_frames")
    folder.mkdir(parents=True, exist_ok=True)
    files, lines = [], []
    try:
        for number, (time, grid) in enumerate(frames):
            file = _write_grid(folder / f"frame_{number:04d}.vtu", grid, {"TimeValue": [time]})
            name = quoteattr(f"{folder.name}/{file.name}")
            lines.append(f'    <DataSet timestep="{time!r}" group="" part="0" file={name}/>\n')
            files.append(file)
    finally:
        if lines:
            with _in_one_step(path) as temporary:
                temporary.write_text(LIST.format("".join(lines)), encoding="utf-8")
    for left in set(folder.glob("frame_*.vtu")) - set(files):
        left.unlink()
    return path, *files


def _write_grid(path: Path, grid: Any, fields: Mapping[str, ArrayLike]) -> Path:
    for name, values in fields.items():
        grid.field_data[name] = np.asarray(values)
    path.parent.mkdir(parents=True, exist_ok=True)
    with _in_one_step(path) as temporary:
        grid.save(temporary)
    return path


@contextmanager
def _in_one_step(path: Path) -> Iterator[Path]:
    """Yield a hidden name with the same ending; a file written there becomes `path` if all goes well."""
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
