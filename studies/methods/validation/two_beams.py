"""Two cantilevers that meet through a soft one-sided spring, measured on a shaker.

L. Woiwode and M. Krack, J. Struct. Dyn. (2024), doi 10.25518/2684-6500.180.  A mini-beam on the right strip
meets a cap nut on the left one across a gap.  Geometry, added masses and stiffness factors are those of their
beam model (maltekrack/NLtest, TESTRIGS/02_VIbeams/setUpLinearModalBeamModel.m).

The mini-beam, free at both ends, is tied to the right beam by w and theta at its root, R (x_right, x_mini) =
0; with N a basis of the null space of R, K = N^T K N and M = N^T M N.  Contact acts on the difference of the
tips, sum phi_k q_k over the modes of both, phi of the left ones negative.  A base acceleration a: Z = a/W^2.
The contact has no length of its own: displacements over the gap depend on a/gap alone.

Two readings of the contact: with all modes it is a stiff spring, against which the mini-beam rattles; without
those from the mini-beam's first on, 10 times faster than the drive, their compliance is in the spring, 1/k +
sum phi_k^2/omega_k^2, and the motions are periodic.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.sparse import block_diag, csr_array

import beam
from contact import BranchEnded, HarmonicDrive, ImpactOscillator, LinearContact, State, Stop, simulate
from contact.orbits import Branch, Shooting, follow_path
from studies.methods.validation.responses import drawn, followed, harmonic
from studies.methods.validation.rows import Curve, Panel, Row, Section, compared
from studies.shell.study import Run

Array = NDArray[np.float64]

LEFT, RIGHT = (30.95, 199.04, 556.82, 1085.93), (28.20, 205.54, 277.74, 594.98, 1168.62)  # measured, Hz
MODEL_ERROR = 0.03  # of frequencies: their beam model, tuned by hand, meets them to 1 ... 3 %
LENGTH, WIDTH, HEIGHT, E, DENSITY, GAP = 0.3925, 0.060, 0.006, 210e9, 7720.0, 0.17e-3
CONTACT, ROOT, PLATE = LENGTH - 0.0115, LENGTH - 0.0625, 0.040
LEVELS, RAISED = (0.020, 0.028, 0.0305), 0.040  # base acceleration [m/s^2]; there all is one curve
LOW, HIGH, BEYOND = 0.95, 1.08, 1.016  # W/w1: range of a response, and where its large motions are
CAPTION = (
    "Two beams, pale where unstable: where (b) falls, large motions are detached.  Damping and frequency of "
    "the left beam's mode 2 decide; only the raw records have them.  Mode 5 of the right beam is off in the "
    "factors of the drawing: exact transfer matrices of it give our number."
)
SETTLE = 250  # drive periods at each step of a scan: free motions die out by a factor of 70


def _strip(
    pieces: Sequence[tuple[float, float, float]],
    nut: float,
    width: float = WIDTH,
    height: float = HEIGHT,
    held: beam.Support = "clamped",
    tip_at: float = CONTACT,
    tie: float = ROOT,
) -> beam.Discretization:
    """A strip, free at its far end, of pieces (length, stiffness over that of steel, added mass)."""
    steel = [
        beam.Material(
            youngs_modulus=factor * E, poissons_ratio=0.3, density=DENSITY + added / (length * width * height)
        )
        for length, factor, added in pieces
    ]
    return beam.assemble(
        beam.LeafSpring(
            centreline=beam.Centreline(pieces=tuple(beam.Straight(length=piece[0]) for piece in pieces)),
            sections=tuple(beam.StripSection(material=m, width=width, thickness=height) for m in steel),
            supports=(held, "free"),
            tip=beam.Tip(mass=nut),
            tip_at=tip_at,
            readouts={"w": beam.Readout(at=tie), "turn": beam.Readout(at=tie, quantity="rotation")},
        )
    )


def both_beams(plate_end: float = ROOT, count: int = 6) -> tuple[beam.Modes, beam.Modes]:
    """Modes of the left beam and of the right one with its mini-beam; the 40 mm of the tuning plate, or of
    the mini-beam's clamp, end at `plate_end` [m] from the support."""

    def bolted(bare: float, factor: float, plate: float, added: float) -> list[tuple[float, float, float]]:
        stiffness = bare * factor * (1.0 + plate * PLATE / WIDTH / HEIGHT) ** 3
        return [(plate_end - PLATE, bare, 0.0), (PLATE, stiffness, added), (LENGTH - plate_end, bare, 0.0)]

    left = _strip(bolted(1.0, 0.75, 1e-3, 0.0427), 0.0133)
    right = _strip(bolted(1.08, 0.1, 13.5e-3, 0.0307 * 40 / 97 + 0.0606 + 0.0543 + 0.0819), 0.0)
    excess = 0.0307 * 57 / 97 - DENSITY * 0.057 * 0.040 * 1e-3
    mini = _strip([(0.057, 1.07, excess)], 0.0, 0.040, 1e-3, "free", CONTACT - ROOT, 0.0)
    basis = null_space([np.append(right.readouts[x], -mini.readouts[x]) for x in ("w", "turn")])
    both = {
        name: csr_array(basis.T @ (block_diag([getattr(x, name) for x in (right, mini)]) @ basis))
        for name in ("stiffness", "mass", "loss_stiffness")
    }
    tied = replace(
        right,
        **both,
        base_load=np.append(right.base_load, mini.base_load) @ basis,
        tip=np.append(0.0 * right.tip, mini.tip) @ basis,
        ties=right.ties @ csr_array(basis[: -mini.n_dofs]),
        readouts={"beam": np.append(right.tip, 0.0 * mini.tip) @ basis},
    )
    return beam.natural_modes(left, count), beam.natural_modes(tied, count)


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Both beams at measured frequencies; damping ratios of the right beam's mode 1 and of all others [1];
    frequency of the left beam's mode 2 [Hz]; whether the mini-beam's modes are part of the contact spring."""

    first: float = 0.0027
    others: float = 0.001
    left_2: float = LEFT[1]
    condensed: bool = True

    @cached_property
    def model(self) -> beam.ModalModel:
        """Modes of both by rising frequency; the read-out is the right beam at the contact."""
        left, right = both_beams()
        hertz = np.array(
            [*RIGHT, *right.frequencies_hz[5:], LEFT[0], self.left_2, *LEFT[2:], *left.frequencies_hz[4:]]
        )
        ratio, order = np.where(hertz == RIGHT[0], self.first, self.others), np.argsort(hertz)
        return beam.ModalModel(
            omega=2.0 * np.pi * hertz[order],
            decay_rate=4.0 * np.pi * (ratio * hertz)[order],
            phi=np.append(right.phi, -left.phi)[order],
            participation=np.append(right.participation, left.participation)[order],
            readouts={"beam": np.append(right.readouts["beam"], 0.0 * left.phi)[order]},
        )

    @cached_property
    def contact(self) -> tuple[beam.ModalModel, Stop]:
        """Modes and stop of this reading."""
        model, law = self.model, LinearContact(stiffness=1e6, damping=100.0)
        if self.condensed:
            slow = model.frequencies_hz < 0.99 * RIGHT[2]
            compliance = 1e-6 + float(np.sum((model.phi[~slow] / model.omega[~slow]) ** 2))
            model, law = model.truncated(int(slow.sum())), LinearContact(stiffness=1.0 / compliance)
        return model, Stop(gap=GAP, law=law)

    def at(self, ratio: float, level: float) -> ImpactOscillator:
        """Driven at W/w1 = `ratio` with `level` [m/s^2]."""
        hertz, (model, stop) = ratio * RIGHT[0], self.contact
        drive = HarmonicDrive(frequency=hertz, amplitude=level / (2.0 * np.pi * hertz) ** 2)
        return ImpactOscillator(model=model, stop=stop, drive=drive)

    def response(self, level: float) -> Branch:
        """The curve over W/w1 that begins where the motion without contact reaches the gap."""
        at = partial(self.at, level=level)
        return followed(at, 1.0, low=LOW, high=HIGH, step=0.2, settling=1000)

    @cached_property
    def raised(self) -> Branch:
        """That at `RAISED`."""
        return self.response(RAISED)

    def lowered(self, ratio: float) -> tuple[float, Branch]:
        """The first W/w1 from `ratio` on of an orbit at `RAISED`, and the curve over the acceleration through
        it."""
        pairs = zip(self.raised.parameters, self.raised.orbits, strict=True)
        beyond = [pair for pair in pairs if pair[0] >= ratio]
        if not beyond:
            at = dict(time=0.0, gap=0.0, velocity=0.0)
            raise BranchEnded(
                **at, detail=f"the response at {RAISED:g} m/s^2 does not reach W/w1 = {ratio:g}"
            )
        place, start = beyond[0]
        return place, follow_path(partial(self.at, place), start, RAISED, low=0.01, high=0.05, step=0.2)

    @cached_property
    def large(self) -> tuple[float, Branch]:
        """W/w1 near `BEYOND`, and the large motions there over the base acceleration."""
        return self.lowered(BEYOND)

    def upper(self, level: float) -> Branch | None:
        """The curve over W/w1 through the large motion at `level` and `BEYOND`; None if there is none."""
        place, down = self.large
        for orbit, a, b in zip(down.orbits, down.parameters, down.parameters[1:], strict=False):
            if (a - level) * (b - level) <= 0.0:
                family = Shooting(oscillator=self.at(place, level), period=1, impacts=orbit.impacts)
                start = family.from_state(replace(orbit.strobe_state(), time=0.0))
                at = partial(self.at, level=level)
                return follow_path(at, start, place, low=LOW, high=HIGH, step=0.2)
        return None


def carried(rig: Rig, path: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Simulated along `path`, pairs (W/w1, base acceleration), the state carried on: W/w1 and first harmonic
    over the gap, NaN without contact."""
    state, phases, found = State.rest(rig.contact[0].n_modes), np.arange(256) / 32, []
    for ratio, level in path:
        driven = rig.at(ratio, level)
        state = replace(simulate(driven, state, periods=SETTLE).end, time=0.0)
        run = simulate(driven, state, periods=8, times=phases * driven.period)
        swing = run.displacement @ driven.model.readouts["beam"] * np.exp(-2j * np.pi * phases)
        found.append((ratio, 2.0 * abs(np.mean(swing)) / GAP if len(run.impacts) else np.nan))
    return found


def backbone(rig: Rig, ratios: Array) -> Array:
    """Rows of W/w1, response over gap and base acceleration [m/s^2] where the right beam lags by a quarter
    period."""
    found = list[tuple[float, float, float]]()
    for ratio in ratios.tolist():
        place, branch = rig.lowered(ratio)
        swings = [harmonic(orbit, "beam") / GAP for orbit in branch.orbits]
        for (a, p), (b, q) in pairwise(zip(swings, branch.parameters, strict=True)):
            if a.real * b.real < 0.0 > a.imag:
                part = a.real / (a.real - b.real)
                found.append((place, abs(a + part * (b - a)), p + part * (q - p)))
    return np.array(found).T


def detached(rig: Rig) -> tuple[float, float]:
    """Base accelerations [m/s^2] from which on the large motions exist, and up to which they are cut off from
    those that begin without contact, to 5e-5."""
    lowest = min(min(rig.lowered(ratio)[1].parameters) for ratio in (1.011, 1.013, 1.015))
    low, high = lowest, RAISED
    while high - low > 5e-5:
        branch = rig.upper(0.5 * (low + high))
        cut_off = branch is None or branch.ended_low == "closed"
        low, high = (0.5 * (low + high), high) if cut_off else (low, 0.5 * (low + high))
    return lowest, high


def of_modes(row: Callable[..., Row]) -> list[Row]:
    """Frequencies beside the measured ones."""
    return [
        row(f"{side}, mode {k} [Hz]", f, a, MODEL_ERROR * f, f"{b:.5g} with the plates 10 mm further out")
        for side, measured, here, out in zip(
            ("left", "right"), (LEFT, RIGHT), both_beams(), both_beams(ROOT + 0.01), strict=True
        )
        for k, f, a, b in zip(range(1, 6), measured, here.frequencies_hz, out.frequencies_hz, strict=False)
    ]


def of_detachment(run: Run, row: Callable[..., Row], rig: Rig) -> list[Row]:
    """Over which damping, frequency and acceleration large motions are detached, and both readings there."""
    rows, cases = list[Row](), dict[str, Rig]()
    if not run.quick:
        cases = {"as assumed": rig}
        cases |= {f"other modes {x:.2%}": Rig(others=x) for x in (0.0005, 0.0015)}
        cases |= {f"mode 1 {x:.2%}": Rig(first=x) for x in (0.0025, 0.003)}
        cases |= {f"left mode 2 {x:+.1%}": Rig(left_2=(1.0 + x) * LEFT[1]) for x in (-0.005, 0.005)}
    for name, found in zip(cases, run.attempt(detached, cases.values(), "detached curves"), strict=True):
        if found is not None:
            note = f"gap {GAP * 1e3:g} mm, in proportion to it; large motions from {found[0]:.4f} m/s^2 on"
            rows.append(row(f"detached up to [m/s^2], {name}", None, found[1], note=note))
    # in both readings: up in frequency at the raised level, then down to the source's
    steps = [(x, RAISED) for x in np.arange(1.0, 1.0121, 1e-3)]
    steps += [(1.012, x) for x in np.arange(RAISED, LEVELS[-1] - 1e-9, -5e-4)]
    smooth, rattling = (carried(replace(rig, condensed=x), steps)[-1][1] for x in (True, False))
    note = f"{smooth:.4f} with the mini-beam as a spring"
    rows.append(row(f"gaps at W/w1 = 1.012 and {LEVELS[-1]} m/s^2, all modes", None, rattling, note=note))
    return rows


def two_beams(run: Run) -> Section:
    """Frequencies; responses at the three accelerations and the curves detached from them; the backbone; over
    which damping, frequency and acceleration (over gap) they are detached."""
    row, rig = partial(compared, "Woiwode and Krack 2024"), Rig()
    rows = of_modes(row)
    curves, size = list[Curve](), lambda orbit: abs(harmonic(orbit, "beam")) / GAP
    for look, level in enumerate(run.track(LEVELS[-1:] if run.quick else LEVELS, "responses of two beams")):
        for words, branch in (("response", rig.response(level)), ("detached curve", rig.upper(level))):
            if branch is not None:
                top, low, high = max(map(size, branch.orbits)), min(branch.parameters), max(branch.parameters)
                note = f"from {low:.5f}, up to {top:.3f} gaps; {branch.ended_high}"
                rows.append(row(f"W/w1 where the {words} turns, {level} m/s^2", None, high, note=note))
                name = f"{level} m/s$^2$" if words == "response" else ""
                stable, unstable = drawn(branch, size, 1.0, look)
                curves += [replace(stable, name=name), replace(unstable, name="")]
            else:
                rows.append(row(f"{words}, {level} m/s^2", None, None, note="none"))
    places, sizes, levels = backbone(rig, np.arange(1.002, 1.024, 4e-3 if run.quick else 5e-4))
    reached = float(np.interp(1.7, sizes, places))
    rows.append(row("W/w1 of the backbone at 1.7 gaps", None, reached, note="theirs stays below 1.03"))
    rows += of_detachment(run, row, rig)
    curves.append(Curve(x=places, y=sizes, name="backbone", look=4))
    return Section(
        rows=rows,
        panels=[
            Panel(title="responses", x=("W/w1", "1"), y=("right beam / gap", "1"), curves=curves),
            Panel(
                title="along the backbone",
                x=("W/w1", "1"),
                y=("base acceleration", "m/s$^2$"),
                curves=[Curve(x=places, y=levels, look=4)],
            ),
        ],
        caption=CAPTION,
    )
