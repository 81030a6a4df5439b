"""Mode shapes and motions as files for ParaView: .vtu meshes, and .pvd lists of them in time.

The mesh is the solid of `spring_mesh`; its cell array `part` is 0 in the strip, 1 in glued layers and 2 on
the ball. Displacements are real vectors of three components [m], and as small as they are in the theory:
drawn large, points move along straight lines.

pyvista is imported only when something is written: writing opens no window and needs no graphics library.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .modes import Modes
from .spring_mesh import SpringMesh, spring_mesh


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
    """Write all mode shapes as vectors on one mesh, a .vtu file.

    Parameters
    ----------
    path : Path
        Ending in .vtu.
    modes : Modes
    decay_rates : array_like, shape (n_modes,), optional
        [1/s].
    largest : float
        Largest displacement of each shape [m].
    ball_radius : float, optional
        [m]; no ball without it.

    Returns
    -------
    Path
        The file. Point arrays: one for each mode, named by `mode_name`. Field arrays: frequencies_hz,
        decay_rates_per_s if they are given, coupled (0 or 1), largest_displacement_m.
    """
    _require_suffix(path, ".vtu")
    mesh = spring_mesh(modes, ball_radius=ball_radius)
    grid = mesh.grid()
    for mode, shape in enumerate(mesh.normalised(largest)):
        grid.point_data[mode_name(modes, mode)] = shape
    fields: dict[str, ArrayLike] = {"frequencies_hz": modes.frequencies_hz}
    if decay_rates is not None:
        rates = np.asarray(decay_rates, dtype=np.float64)
        if rates.shape != modes.omega.shape:
            raise ValueError(f"decay_rates has shape {rates.shape}; it must be {modes.omega.shape} [1/s].")
        fields["decay_rates_per_s"] = rates
    fields |= {"coupled": modes.coupled.astype(np.int8), "largest_displacement_m": [largest]}
    return _write_grid(path, grid, fields)


def write_mode_motion(
    path: Path,
    modes: Modes,
    mode: int,
    *,
    frames: int = 24,
    moved: bool = False,
    largest: float = 0.01,
    ball_radius: float | None = None,
) -> tuple[Path, ...]:
    """Write one period of one mode, undamped, that repeats without a seam.

    The frame after the last would be the first again, and is not written.

    Parameters
    ----------
    path : Path
        Ending in .pvd.
    modes : Modes
    mode : int
        From 0.
    frames : int
        At least 2.
    moved : bool
        Whether the points themselves move. If not, they stay, and the array `displacement` [m] is there for
        ParaView's filter Warp By Vector.
    largest, ball_radius
        As for `write_modes`.

    Returns
    -------
    tuple of Path
        The .pvd file, then its frames. A rigid motion, which has no period, is given one second.
    """
    if not 0 <= mode < modes.omega.size:
        raise ValueError(f"mode is {mode} [1]; it must lie between 0 and {modes.omega.size - 1}.")
    if frames < 2:
        raise ValueError(f"frames is {frames} [1]; it must be at least 2.")
    mesh = spring_mesh(modes, ball_radius=ball_radius)
    period = 2.0 * math.pi / modes.omega[mode] if modes.omega[mode] > 0.0 else 1.0
    phase = np.arange(frames) / frames
    shape = mesh.normalised(largest)[mode]
    frame_of = (math.cos(2.0 * math.pi * part) * shape for part in phase)
    fields = {"frequency_hz": [modes.frequencies_hz[mode]], "largest_displacement_m": [largest]}
    return _write_frames(path, mesh, phase * period, frame_of, moved, fields)


def write_motion(
    path: Path,
    modes: Modes,
    times: ArrayLike,
    coordinates: ArrayLike,
    *,
    base: ArrayLike | None = None,
    moved: bool = False,
    magnification: float = 1.0,
    ball_radius: float | None = None,
) -> tuple[Path, ...]:
    """Write a motion given by its modal coordinates.

    Parameters
    ----------
    path : Path
        Ending in .pvd.
    modes : Modes
    times : array_like, shape (n_frames,)
        [s].
    coordinates : array_like, shape (n_frames, n_modes)
        q_k [kg^(1/2) m] of all of `modes`.
    base : array_like, shape (n_frames,), optional
        Displacement of the base [m]; without it the base, on which the stop rides, is the frame of reference.
    moved, ball_radius
        As for `write_mode_motion`.
    magnification : float
        Of all displacements [1].

    Returns
    -------
    tuple of Path
        The .pvd file, then its frames.
    """
    t, q = np.asarray(times, dtype=np.float64), np.asarray(coordinates, dtype=np.float64)
    z = np.zeros(t.shape) if base is None else np.asarray(base, dtype=np.float64)
    if t.ndim != 1 or t.size == 0 or q.shape != (t.size, modes.omega.size) or z.shape != t.shape:
        raise ValueError(
            f"times, coordinates and base have shapes {t.shape}, {q.shape}, {z.shape}; they must be "
            f"(n_frames,), (n_frames, {modes.omega.size}), (n_frames,)."
        )
    mesh = spring_mesh(modes, ball_radius=ball_radius)
    drive = np.array([*modes.discretization.spring.drive, 0.0])
    frame_of = (
        magnification * (np.tensordot(row, mesh.shapes, axes=1) + shift * drive)
        for row, shift in zip(q, z, strict=True)
    )
    return _write_frames(path, mesh, t, frame_of, moved, {"magnification": [magnification]})


def _write_frames(
    path: Path,
    mesh: SpringMesh,
    times: NDArray[np.float64],
    displacements: Iterator[NDArray[np.float64]],
    moved: bool,
    fields: Mapping[str, ArrayLike],
) -> tuple[Path, ...]:
    """Write NAME.pvd and NAME_frames/frame_0000.vtu and so on."""
    _require_suffix(path, ".pvd")
    folder = path.with_name(f"{path.stem}_frames")
    folder.mkdir(parents=True, exist_ok=True)
    files, lines = [], []
    for number, (time, displacement) in enumerate(zip(times.tolist(), displacements, strict=True)):
        grid = mesh.grid(mesh.points + displacement if moved else None)
        grid.point_data["displacement"] = displacement
        files.append(_write_grid(folder / f"frame_{number:04d}.vtu", grid, {**fields, "TimeValue": [time]}))
        name = quoteattr(f"{folder.name}/{files[-1].name}")
        lines.append(f'    <DataSet timestep="{time!r}" group="" part="0" file={name}/>\n')
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        "  <Collection>\n" + "".join(lines) + "  </Collection>\n</VTKFile>\n",
        encoding="utf-8",
    )
    return path, *files


def _write_grid(path: Path, grid: Any, fields: Mapping[str, ArrayLike]) -> Path:
    for name, values in fields.items():
        grid.field_data[name] = np.asarray(values)
    path.parent.mkdir(parents=True, exist_ok=True)
    grid.save(path)
    return path


def _require_suffix(path: Path, suffix: str) -> None:
    if path.suffix != suffix:
        raise ValueError(f"path is {path}; its name must end in {suffix}.")
