"""The spring in motion: one period of a settled orbit as a film, slow at the collision.

Higher modes are drawn enlarged, so that they show.  The ball is where the tip is: it meets the plate when the
computed tip does, and the plate gets orange edges while they touch.  Below, the tip against time.  For
ParaView motion.pvd with motion_frames has the arrays `displacement`, true, and the points as they are drawn.

Times count from the strobe at which the film begins. The step from frame to frame is that of the flight, at
most the distance from the nearest contact over `NEARER`, and 1/`IN_CONTACT` of a contact while it lasts:

    step(t) = clip(distance(t)/NEARER, contact/IN_CONTACT, flight)

and the frames lie where the integral of dt/step reaches whole numbers.

Drawn is the shape of mode 1 that carries the whole tip displacement x, and the departure from it, enlarged M
times:

    (x/phi_1) Phi_1 + M sum_{k>=2} q_k [Phi_k - (phi_k/phi_1) Phi_1]

The departure leaves the tip where it is: with any M the ball meets the plate when the computed tip meets it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beam import Modes, SpringMesh, write_frames
from contact import ImpactKind, ImpactOscillator, State, simulate
from contact.orbits import Settled
from studies.experiment.trace import Trace, touching
from studies.shell.digits import minus
from studies.shell.film import RATE, write_film
from studies.shell.painter import DRIVE, TOUCHED, Moment, Scenery, stage_of
from studies.shell.scene import Scene, modes_of
from studies.shell.study import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

CUE = 2.0  # times slower than the flight, from where on the film says so in words


def film(
    scene: Scene,
    run: Run,
    oscillator: ImpactOscillator,
    settled: Settled,
    trace: Trace,
    words: str,
    *,
    frames: int,
    enlarged: float | None = None,
) -> Mapping[str, object]:
    """Film one period of a settled orbit; returns what the summary keeps of it.

    Higher modes are drawn `enlarged` times, by default as much as shows well.
    """
    modes, radius = modes_of(scene), scene.tip.ball_radius_m
    gaps = [stop.side * stop.gap for stop in oscillator.stops if stop.at == "tip"]
    orbit = film_orbit(oscillator, settled.end, settled.m, frames=frames, rate=RATE)
    scenery = Scenery.of(modes, ball_radius=radius, gaps=gaps, amplitude=float(np.abs(orbit.tip).max()))
    drawn, magnification = drawn_shapes(scenery.mesh, modes, orbit.coordinates, enlarged)
    true, _ = drawn_shapes(scenery.mesh, modes, orbit.coordinates, 1.0)
    scaled = [f"higher modes are drawn {magnification:g} times larger"] if magnification > 1.0 else []
    marks = zip(1e3 * orbit.time, 1e3 * orbit.tip, strict=True)
    moments = [
        Moment(points=points, base=base * DRIVE, touched=plates, lines=[words, *scaled, *lines], mark=mark)
        for points, base, plates, lines, mark in zip(
            drawn, orbit.base, orbit.touched, lines_of(orbit), marks, strict=True
        )
    ]

    def grids() -> Iterator[tuple[float, Any]]:
        """Time [s] and pyvista.UnstructuredGrid of every frame, the points as they are drawn."""
        for time, moment, displacement in zip(orbit.time.tolist(), moments, true, strict=True):
            grid = scenery.mesh.grid(scenery.placed(moment))
            grid.point_data["displacement"] = displacement
            yield time, grid

    write_frames(run.path("motion.pvd", "The film for ParaView: times [s] of the frames."), grids())
    run.path("motion_frames", "Frames of motion.pvd: points as drawn, true displacement [m].")
    slow = f"{orbit.slowed.min():.0f} to {orbit.slowed.max():.0f} times slower than life"
    run.say(f"{words}: {len(orbit.contacts)} contacts, {slow}")
    holds = "One period of the orbit, slow at the collision; below, the ball against time."
    stage = stage_of(scenery, graph=graph_of(trace, gaps, orbit.duration))
    write_film(run, "motion", holds, stage, moments, video=True)
    return {"contacts_s": orbit.contacts, "magnification": magnification}


def lines_of(orbit: FilmedOrbit) -> Iterator[tuple[str, str]]:
    """What is written above each frame: how slow it is shown, time and tip."""
    for time, tip, slowed, touched in zip(orbit.time, orbit.tip, orbit.slowed, orbit.touched, strict=True):
        cue = ", near the impact" if slowed > CUE * orbit.slowed.min() else ""
        place = "touches the plate" if any(touched) else f"is at {minus(f'{1e3 * tip:.2f}')} mm"
        yield (
            f"slow motion: {float(f'{slowed:.2g}'):g} times slower{cue}",
            f"at {1e3 * time:.2f} ms the ball {place}",
        )


def graph_of(trace: Trace, gaps: Sequence[float], duration: float) -> Callable[[Axes], None]:
    """The tip against time, its impacts ringed, with the plates at `gaps` [m], as it stands below a frame."""

    def graph(axes: Axes) -> None:
        from studies.shell.plotting import BLUE, GUIDE, NOTE, Style, label  # matplotlib is slow to import

        axes.plot(1e3 * trace.time, 1e3 * trace.tip, color=BLUE)
        hits = trace.impact_times
        ring: Style = {"color": TOUCHED, "markersize": 11, "markerfacecolor": "none"}
        axes.plot(1e3 * hits, 1e3 * np.interp(hits, trace.time, trace.tip), "o", **ring, clip_on=False)
        across = axes.get_yaxis_transform()
        for gap in gaps:
            axes.axhline(1e3 * gap, **GUIDE)
            axes.text(1.0, 1e3 * gap, "plate", transform=across, fontsize=NOTE, va="center")
        axes.set_xlim(0.0, 1e3 * duration)
        label(axes.xaxis, "time", "ms")
        label(axes.yaxis, "ball", "mm")

    return graph


NEARER, IN_CONTACT = 8.0, 6.0
FLIGHT_STEPS = 120.0  # steps of the flight in a whole film, were there no contacts

APERIODIC = 4  # drive periods shown of a motion that has no period

LARGEST, MOST = 0.07, 100.0
"""Largest enlarged departure over the greatest extent of the strip; enlargement beyond which nothing is
seen."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmedOrbit:
    """One period of an orbit, arrays by frame; times from the strobe at which it begins [s].

    `slowed`: how many times slower than life a frame is shown; `coordinates`: modal, (n_frames, n_modes);
    `touched`: whether each plate at the tip is, (n_frames, n_plates).
    """

    duration: float
    contacts: list[tuple[float, float]]  # begin and end of each [s]
    time: Array
    slowed: Array
    tip: Array
    base: Array
    touched: NDArray[np.bool_]
    coordinates: Array


def frame_times(duration: float, contacts: list[tuple[float, float]], frames: int) -> Array:
    """Times of `frames` frames over a period that begins again [s], shape (frames,)."""
    around = [(a + n * duration, b + n * duration) for n in (-1, 0, 1) for a, b in contacts]
    flight = duration / FLIGHT_STEPS
    lengths = [last - first for first, last in contacts if last > first]
    least = min(flight, float(np.median(lengths)) / IN_CONTACT if lengths else flight / 50.0)
    edges = [place for span in around for place in span if 0.0 <= place <= duration]
    near = [place + sign * least * 1.05**k for place in edges for k in range(200) for sign in (-1, 1)]
    fine = np.unique(np.clip([*np.linspace(0.0, duration, 4001), *edges, *near], 0.0, duration))
    step = np.full(fine.shape, flight)
    for first, last in around:
        distance = np.maximum(np.maximum(first - fine, fine - last), 0.0)
        step = np.minimum(step, np.maximum(distance / NEARER, least))
    passed = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(fine) * (1.0 / step[1:] + 1.0 / step[:-1]))])
    times: Array = np.interp(np.arange(frames) / frames * passed[-1], passed, fine)
    return times


def film_orbit(
    oscillator: ImpactOscillator, state: State, m: int, *, frames: int, rate: float
) -> FilmedOrbit:
    """The motion from `state`, which lies at a strobe, in so many frames at `rate` a second."""
    length = m or APERIODIC
    duration, begin, points = length * oscillator.period, state.time, [stop.at for stop in oscillator.stops]
    whole = simulate(oscillator, state, periods=length + 1)
    felt = (whole.impacts.kind != ImpactKind.GRAZE) & (whole.impacts.start < begin + duration)
    spans = zip(whole.impacts.start[felt] - begin, whole.impacts.end[felt] - begin, strict=True)
    contacts = [(float(a), float(b) if math.isfinite(b) else duration) for a, b in spans]
    times = frame_times(duration, contacts, frames)
    run = simulate(oscillator, state, periods=length + 1, times=begin + times)
    return FilmedOrbit(
        duration=duration,
        contacts=contacts,
        time=times,
        slowed=1.0 / (rate * np.diff(times, append=duration)),
        tip=oscillator.tip(run.displacement),
        base=oscillator.driven.displacement(times),
        touched=np.transpose([touching(run, i) for i, at in enumerate(points) if at == "tip"]),
        coordinates=run.displacement,
    )


def drawn_shapes(
    mesh: SpringMesh, modes: Modes, coordinates: Array, magnification: float | None = None
) -> tuple[Array, float]:
    """Displacements of the points of the mesh relative to the base (n_frames, n_points, 3) [m], and M [1].

    `coordinates` (n_frames, n_modes) belong to the coupled modes.

    M is the largest whole number with which the departures stay below `LARGEST`, unless it is given.
    """
    kept = np.flatnonzero(modes.coupled)[: coordinates.shape[1]]
    phi, strip = modes.phi[kept], np.unique(mesh.hexahedra)
    first = mesh.shapes[kept[0]] / phi[0]
    departures = np.tensordot(coordinates, mesh.shapes[kept] - phi[:, None, None] * first, axes=1)
    carried = (coordinates @ phi)[:, None, None] * first
    # the ball is drawn where the tip is, and does not turn
    ball, drive = np.unique(mesh.triangles), np.array([*modes.discretization.spring.drive, 0.0])
    departures[:, ball] = 0.0
    carried[:, ball] = ((coordinates @ phi)[:, None] * drive)[:, None]
    if magnification is None:
        largest = float(np.linalg.norm(departures[:, strip], axis=2).max())
        most = LARGEST * float(np.ptp(mesh.points[strip], axis=0).max())
        magnification = min(MOST, max(1.0, math.floor(most / largest))) if largest > 0.0 else 1.0
    return carried + magnification * departures, magnification
