"""The letter's other claims, each with the numbers that decide it.

Claims (letter 1996), for the Nordmark map (Eqs. (2), (3)), Eq. (1) and springs with many modes:

    a   "The magnitude of the hysteresis |rho_m| decreases with increasing energy loss":
        F_m/F_g - 1 against tau
    b   "In the mapping these secondary bifurcations always occur at rho > 0. In Eq. (1) [they] may occur at
        values rho < 0 that become smaller if collisions become more elastic": the first one against tau
    c   "bands in the (alpha, gamma) parameter plane ... crossed approximately transversely"; "At the upper
        boundary ... there is no hysteresis. The hysteresis increases towards ... the lower-lying m - 1"
    d   "These phenomena ... are independent of the details of the dynamics in between collisions. They are,
        therefore, predicted to be universal": born period against f T for several springs and contact laws
    e   "an infinite series of period addings for the overdamped oscillator": windows of p_m and chaos as
        rho -> 0+

**Second impact of Eq. (1).**  At time s after its impact the tip of an orbit with approach speed v is at

    x - gap = v G(s) - gap (1 - cos w s),   G = h - s_0 cos w s + b sin w s,

(s_0, b) the arms of the family, h the free motion per unit speed: linear in v.  Hence the first orbit with a
second impact has v_2 = min over G > 0 of gap (1 - cos w s)/G(s).  The trace of its multipliers is p + q/v, so
that the flip (multiplier -1) has v = -q/(1 + D + p), D their determinant; the secondary bifurcation is the
one that comes first above the fold.

**Overdamped map** with eigenvalues 1 > l > l' >= 0 of the motion without impact.  For gamma = 0 (l' = 0,
l = alpha) p_m has, as rho -> 0+,

    x_0 = l^(2m-2) z^2,   rho = l^(2m-2) (1 - l) z (z + 1),   1/2 < z < (1 - l)/l,

stable above the lower end, without a second impact below the upper one.  The windows of rho are empty for
l > 2/3, overlap for l < 1/4, and leave gaps in between, ln((3/4)/(1 - l)) / (2 ln(1/l)) of ln rho, that chaos
fills: computed here from the exact orbits and, independently, from Lyapunov exponents.
Source: W. Chin, E. Ott, H. E. Nusse, C. Grebogi, Phys. Rev. E 50 (1994) 4427.

Run time: about a minute; --quick some ten seconds.  Command: python -m studies.claims.  Outputs: summary.json
with {"holds", "numbers", "sentence"} for each claim, and a figure (png, pdf) and a csv for each.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.ticker import NullFormatter
from scipy.optimize import brentq, minimize_scalar

from beam import ModalModel
from contact.errors import ContactError
from contact.maximal_orbits import band, fold, maximal_orbits, maximal_period, maximal_periods, stable_range
from contact.nordmark import NordmarkMap
from contact.orbits.single_impact import MaximalFamily
from contact.stroboscope import StroboscopicMap
from studies.instruments.command_line import Request, run_study
from studies.instruments.figures import PAGE, PALETTE, house_style, label, new_figure, series
from studies.instruments.oscillators import beam_of, single_mode_oscillator
from studies.instruments.periodicity import settle
from studies.instruments.scene import Scene
from studies.instruments.spring_of_scene import model_of
from studies.instruments.tip_mass_family import bare_cantilever, with_mass_ratio

RESTITUTIONS = np.round(np.linspace(0.0, 0.9, 19), 3)
MONOTONE = 1e-12
"""Change of an excess that is rounding."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """The verdict on one claim: `holds` is None where the computation cannot decide."""

    holds: bool | None
    numbers: Mapping[str, Any]
    sentence: str
    table: Mapping[str, Sequence[Any]]
    figure: Any

    def as_dict(self) -> dict[str, Any]:
        return {"holds": self.holds, "numbers": dict(self.numbers), "sentence": self.sentence}


@dataclass(frozen=True, kw_only=True)
class Leaf:
    """Eq. (1) without its restitution: free period [s] and decay rate [1/s]."""

    free_period: float
    decay_rate: float

    @staticmethod
    def of(scene: Scene) -> Leaf:
        return Leaf(
            free_period=scene.single_mode.free_period_s, decay_rate=scene.single_mode.decay_rate_per_s
        )

    def map(self, frequency: float, restitution: float) -> NordmarkMap:
        return NordmarkMap.from_frequencies(
            drive_frequency=frequency,
            free_period=self.free_period,
            decay_rate=self.decay_rate,
            restitution=restitution,
        )

    def family(self, frequency: float, restitution: float, period: int) -> MaximalFamily:
        return MaximalFamily.single_mode(
            drive_frequency=frequency,
            free_period=self.free_period,
            decay_rate=self.decay_rate,
            restitution=restitution,
            period=period,
        )

    def period(self, frequency: float, restitution: float) -> int:
        """The m of the band of the map."""
        return maximal_period(self.map(frequency, restitution))


# second impacts -------------------------------------------------------------------------------------------


def second_impact_speed(family: MaximalFamily, points: int = 2000) -> float:
    """v_2 [m/s] of a family of one mode, infinity if there is none (`points` for each drive period)."""
    duration, w = family.period / family.drive_frequency, family.angular_frequency
    half, damped = (
        0.5 * float(family.decay_rate[0]),
        math.sqrt(float(family.omega[0]) ** 2 - (0.5 * float(family.decay_rate[0])) ** 2),
    )
    height, rate = (float(row[0]) * float(family.phi[0]) for row in family.deviations[1])
    s0, b = family.arms

    def ratio(s: Any) -> Any:
        decay = np.exp(-half * s)
        free = decay * (height * np.cos(damped * s) + (rate + half * height) / damped * np.sin(damped * s))
        reach = free - s0 * np.cos(w * s) + b * np.sin(w * s)
        return np.where(
            reach > 0.0, family.gap * (1.0 - np.cos(w * s)) / np.where(reach > 0.0, reach, 1.0), np.inf
        )

    # the ends are the impact itself, where both sides vanish and rounding decides
    times = np.linspace(0.0, duration, points * family.period + 1)[1:-1]
    values = ratio(times)
    i = int(np.argmin(values))
    if not np.isfinite(values[i]):
        return math.inf
    if 0 < i < times.size - 1:
        best = minimize_scalar(
            lambda s: float(ratio(s)),
            bounds=(times[i - 1], times[i + 1]),
            method="bounded",
            options={"xatol": 1e-12 * duration},
        )
        return min(float(best.fun), float(values[i]))
    return float(values[i])


def flip_speed(family: MaximalFamily) -> float:
    """Approach speed [m/s] of the multiplier -1 of a family of one mode, infinity if there is none."""
    speeds = (1e-3 * family.gap * family.angular_frequency, family.gap * family.angular_frequency)
    first, second = (float(np.trace(family.orbit(v).monodromy())) for v in speeds)
    q = (first - second) / (1.0 / speeds[0] - 1.0 / speeds[1])
    p = second - q / speeds[1]
    size = 1.0 + float(np.linalg.det(family.orbit(speeds[1]).monodromy())) + p
    v = -q / size if size != 0.0 else math.inf
    return v if v > 0.0 else math.inf


@dataclass(frozen=True, kw_only=True)
class Secondary:
    """The first bifurcation of the node p_m above its fold: excesses of both; `admissible`: the fold."""

    fold: float
    excess: float
    kind: str
    admissible: bool


def secondary(family: MaximalFamily) -> Secondary | None:
    """Of Eq. (1); None where there is no fold."""
    s, b = family.arms
    if not s > 0.0:
        return None
    least = s * family.gap / (s * s + b * b)
    second, flip = second_impact_speed(family), flip_speed(family)
    flip = flip if flip > least else math.inf
    first = min(second, flip)
    return Secondary(
        fold=family.excess(least),
        excess=family.excess(first) if math.isfinite(first) else math.inf,
        kind="second impact" if second <= flip else "flip",
        admissible=second > least,
    )


def secondary_of_map(nordmark: NordmarkMap, period: int) -> Secondary | None:
    """Of the map."""
    end, stable = fold(nordmark, period), stable_range(nordmark, period)
    if end is None or stable is None:
        return None
    high = stable[1]
    return Secondary(
        fold=nordmark.excess(end.rho),
        excess=nordmark.excess(high) if math.isfinite(high) else math.inf,
        kind="second impact",
        admissible=end.admissible,
    )


# a, b -----------------------------------------------------------------------------------------------------


def frequencies_of(scene: Scene) -> list[float]:
    return sorted(scene.drive.frequencies_hz)


def falls(values: Sequence[float]) -> bool:
    return bool(np.all(np.diff(values) <= MONOTONE))


def hysteresis_claim(scene: Scene) -> Claim:
    """a: F_m/F_g - 1 against tau."""
    leaf = Leaf.of(scene)
    table: dict[str, list[Any]] = {
        n: [] for n in ("frequency_hz", "m", "restitution", "map", "rho", "eq1", "admissible")
    }
    figure, axes = new_figure(1, 2, width=PAGE, height=0.072)
    numbers: dict[str, Any] = {}
    good = {"map": True, "eq1": True, "rho": True}
    for number, f in enumerate(frequencies_of(scene)):
        m = leaf.period(f, 0.0)
        ends, rhos, exact, real = [], [], [], []
        for tau in RESTITUTIONS.tolist():
            nordmark, family = leaf.map(f, tau), leaf.family(f, tau, m)
            end, found = fold(nordmark, m), secondary(family)
            ends.append(math.nan if end is None else -nordmark.excess(end.rho))
            rhos.append(math.nan if end is None else -end.rho)
            exact.append(math.nan if found is None else -found.fold)
            real.append(found is not None and found.admissible)
        for name, column in zip(
            table,
            (
                [f] * len(ends),
                [m] * len(ends),
                RESTITUTIONS.tolist(),
                [-v for v in ends],
                [-v for v in rhos],
                [-v for v in exact],
                real,
            ),
            strict=True,
        ):
            table[name] += column
        # less energy lost, more hysteresis: in order of falling tau the values fall
        good["map"] &= falls(ends[::-1])
        good["rho"] &= falls(rhos[::-1])
        mask = np.array(real)
        good["eq1"] &= falls(np.array(exact)[mask][::-1].tolist())
        numbers[f"{f:g} Hz"] = {
            "m": m,
            "map": [-ends[0], -ends[-1]],
            "rho": [-rhos[0], -rhos[-1]],
            "eq1": [-exact[0], -exact[-1]],
            "largest_restitution_of_a_real_fold": float(RESTITUTIONS[mask].max()) if mask.any() else None,
        }
        style = series(number)
        axes[0].plot(
            RESTITUTIONS, 1e2 * np.array(ends), markevery=3, **style, label=f"{f:.2f} Hz, p$_{{{m}}}$"
        )
        axes[1].plot(RESTITUTIONS, np.where(mask, 1e2 * np.array(exact), np.nan), markevery=3, **style)
    with house_style():
        for axis, title in zip(axes, ("(a) Nordmark map", "(b) Eq. (1)"), strict=True):
            axis.set_yscale("log")
            axis.set_title(title)
            label(axis.xaxis, "restitution τ")
            axis.set_ylim(4e-3, 30.0)
        label(axes[0].yaxis, "hysteresis 1 - F$_m$/F$_g$", "%")
        figure.legend(loc="outside lower center", ncols=3)
    sentence = (
        "The hysteresis in the drive amplitude falls with rising energy loss in the map and in Eq. (1)"
        if good["map"] and good["eq1"]
        else "The hysteresis does not fall with rising energy loss everywhere"
    ) + (
        ", and so does |rho_m| of the map."
        if good["rho"]
        else "; |rho_m| of the map itself rises instead; the trend is that of rho per F."
    )
    return Claim(
        holds=good["map"] and good["eq1"],
        numbers={**numbers, "falls": good},
        sentence=sentence,
        table=table,
        figure=figure,
    )


def secondary_claim(scene: Scene, quick: bool) -> Claim:
    """b: the first secondary bifurcation against tau, and where it lies below grazing."""
    leaf = Leaf.of(scene)
    table: dict[str, list[Any]] = {
        n: [] for n in ("frequency_hz", "m", "restitution", "map", "eq1", "kind", "fold_eq1")
    }
    figure, axes = new_figure(1, 2, width=PAGE, height=0.084)
    numbers: dict[str, Any] = {}
    for number, f in enumerate(frequencies_of(scene)):
        m = leaf.period(f, 0.0)
        column = [secondary(leaf.family(f, tau, m)) for tau in RESTITUTIONS.tolist()]
        maps = [secondary_of_map(leaf.map(f, tau), m) for tau in RESTITUTIONS.tolist()]
        values = [math.nan if c is None or not c.admissible else c.excess for c in column]
        for tau, c, other in zip(RESTITUTIONS.tolist(), column, maps, strict=True):
            for name, value in zip(
                table,
                (
                    f,
                    m,
                    tau,
                    None if other is None else other.excess,
                    None if c is None else c.excess,
                    None if c is None else c.kind,
                    None if c is None else c.fold,
                ),
                strict=True,
            ):
                table[name].append(value)
        numbers[f"{f:g} Hz"] = {
            "m": m,
            "eq1": values,
            "falls_with_restitution": falls([v for v in values if math.isfinite(v)]),
        }
        axes[0].plot(
            RESTITUTIONS,
            1e2 * np.array(values),
            markevery=3,
            **series(number),
            label=f"{f:.2f} Hz, p$_{{{m}}}$",
        )
    # the (f, tau) plane: where the node p_m is lost below grazing
    across = np.linspace(19.62, 23.75, 60 if quick else 240)
    upwards = np.linspace(0.0, 0.9, 10 if quick else 46)
    where, lowest = np.full((upwards.size, across.size), np.nan), math.inf
    for j, tau in enumerate(upwards.tolist()):
        for i, f in enumerate(across.tolist()):
            nordmark = leaf.map(f, tau)
            m = maximal_period(nordmark)
            other = secondary_of_map(nordmark, m)
            if other is not None and m in maximal_periods(nordmark):
                lowest = min(lowest, other.excess)
            found = secondary(leaf.family(f, tau, m))
            if found is not None:
                where[j, i] = 2.0 if not found.admissible else 1.0 if found.excess < 0.0 else 0.0
    below = np.nanmean(where > 0.0, axis=1)
    picture = axes[1].pcolormesh(
        across * leaf.free_period,
        upwards,
        where,
        cmap=_three(),
        vmin=-0.5,
        vmax=2.5,
        rasterized=True,
        shading="nearest",
    )
    numbers |= {
        "map_lowest_excess": lowest,
        "part_of_band_below_grazing": {
            f"tau {tau:g}": float(part) for tau, part in zip(upwards, below, strict=True)
        },
    }
    rises = bool(np.all(np.diff(below) >= -0.02))
    always = lowest > 0.0
    some, less = bool(below.max() > 0.0), bool(below[0] < below[-1])
    with house_style():
        axes[0].axhline(0.0, color="0.6", linewidth=0.6)
        axes[0].set_title("(a) Eq. (1)")
        label(axes[0].xaxis, "restitution τ")
        label(axes[0].yaxis, "excess of the secondary bifurcation", "%")
        figure.legend(loc="outside lower center", ncols=3)
        for m in range(3, 11):
            entry = 2 * m / (2 * m + 1)
            if across[0] * leaf.free_period < entry < across[-1] * leaf.free_period:
                axes[1].axvline(entry, color="black", linewidth=0.5)
        axes[1].set_title("(b) Eq. (1): the secondary bifurcation is")
        label(axes[1].xaxis, "f T")
        label(axes[1].yaxis, "restitution τ")
        bar = figure.colorbar(
            picture, ax=axes[1], ticks=[0, 1, 2], location="bottom", aspect=40, drawedges=False
        )
        bar.ax.set_xticklabels(["above grazing", "below grazing", "no simple p$_m$ at the fold"])
        bar.outline.set_visible(False)  # type: ignore[operator]
    monotone = [numbers[f"{f:g} Hz"]["falls_with_restitution"] for f in frequencies_of(scene)]
    numbers |= {"below_rises_with_restitution": rises, "excess_falls_at": sum(monotone)}
    holds = always and some and less and rises
    return Claim(
        holds=holds,
        numbers=numbers,
        table=table,
        figure=figure,
        sentence=(
            "In the map the node p_m keeps to one impact up to grazing at all frequencies and restitutions "
            f"(lowest secondary bifurcation at excess {lowest:.2g}); in Eq. (1) it does not in "
            f"{100 * below[0]:.0f} % of the scanned frequencies at tau = 0, "
            f"{100 * float(np.interp(0.1, upwards, below)):.0f} % at 0.1, {100 * below[-1]:.0f} % at 0.9; at "
            f"a fixed frequency the excess falls with tau throughout at {sum(monotone)} of {len(monotone)}."
        ),
    )


def _three() -> Any:
    return ListedColormap(["#CFE8F7", "#0072B2", "#E69F00"])


# c --------------------------------------------------------------------------------------------------------


def lower_angle(period: int, gamma: float, restitution: float) -> float:
    """theta at the lower edge of a band at fixed gamma: sin((m-1) theta)/sin(theta) = -tau^2 gamma^(m/2)."""
    m, ratio = period, restitution**2 * gamma ** (0.5 * period)
    if m == 2:
        return math.pi

    def height(past: float) -> float:
        return ratio * math.sin((math.pi + past) / (m - 1)) - math.sin(past)

    return (math.pi + float(brentq(height, 0.0, 0.5 * math.pi, xtol=1e-15))) / (m - 1)


def bands_claim(scene: Scene, quick: bool) -> Claim:
    """c: bands in the (alpha, gamma) plane, the path of the experiment, and the hysteresis along it."""
    leaf, tau = Leaf.of(scene), scene.single_mode.restitution
    figure, axes = new_figure(1, 2, width=PAGE, height=0.070)
    gammas = np.linspace(0.02, 1.0, 80)
    for m in range(3, 9):
        angles = [[math.pi / m] * gammas.size, [lower_angle(m, float(g), tau) for g in gammas]]
        edges = [2.0 * np.sqrt(gammas) * np.cos(angle) for angle in angles]
        axes[0].fill_betweenx(gammas, edges[1], edges[0], color=PALETTE[m % 6 + 1], alpha=0.35, linewidth=0.4)
        axes[0].text(
            0.5 * (edges[0][-1] + edges[1][-1]),
            1.015,
            f"{m}",
            fontsize=7,
            ha="center",
            va="bottom",
        )
    path = np.linspace(19.6, 23.8, 200)
    alpha = [leaf.map(f, tau).alpha for f in path.tolist()]
    gamma = [leaf.map(f, tau).gamma for f in path.tolist()]
    axes[0].plot(alpha, gamma, color="black", linewidth=1.4)
    places = [f for f in frequencies_of(scene)]
    axes[0].plot(
        [leaf.map(f, tau).alpha for f in places],
        [leaf.map(f, tau).gamma for f in places],
        linestyle="none",
        marker="o",
        markersize=3.2,
        color="black",
    )
    table: dict[str, list[Any]] = {n: [] for n in ("m", "frequency_hz", "map", "eq1")}
    zero, grows, ratios = [], {"map": True, "eq1": True}, {}
    for m in range(3, 12):
        edge = band(m, free_period=leaf.free_period, decay_rate=leaf.decay_rate, restitution=tau)
        inside = np.linspace(edge.lower, edge.upper, 26 if quick else 101)[:-1]
        inside = np.append(inside, edge.upper - 1e-7 * (edge.upper - edge.lower))
        map_values, exact = [], []
        for f in inside.tolist():
            nordmark = leaf.map(f, tau)
            end, orbit = fold(nordmark, m), leaf.family(f, tau, m).fold()
            map_values.append(0.0 if end is None else -nordmark.excess(end.rho))
            exact.append(0.0 if orbit is None else -orbit.excess)
        table["m"] += [m] * inside.size
        table["frequency_hz"] += inside.tolist()
        table["map"] += map_values
        table["eq1"] += exact
        zero.append(max(map_values[-1], exact[-1]))
        grows["map"] &= falls(map_values)
        grows["eq1"] &= falls(exact)
        ratios[f"p{m}"] = {
            "lower_hz": edge.lower,
            "upper_hz": edge.upper,
            "map": map_values[0],
            "eq1": exact[0],
        }
        shown = (inside >= 19.6) & (inside <= 23.8)
        for values, style in ((map_values, "-"), (exact, "--")):
            axes[1].plot(
                inside[shown],
                1e2 * np.array(values)[shown],
                color=PALETTE[m % 6 + 1],
                linestyle=style,
                linewidth=1.1,
            )
        if m < 10:
            middle = max(edge.lower, 19.6)
            axes[1].text(
                0.3 * edge.upper + 0.7 * middle,
                105.0 * exact[0] if edge.lower > 19.6 else 3.2,
                f"{m}",
                fontsize=7,
                ha="left",
            )
    with house_style():
        axes[0].set_title("(a) bands of p$_m$ as ρ → 0", pad=12)
        label(axes[0].xaxis, "α")
        label(axes[0].yaxis, "γ")
        axes[0].annotate(
            "19.6 to 23.8 Hz",
            (alpha[60], gamma[60]),
            xytext=(0.05, 0.62),
            fontsize=7,
            arrowprops={"arrowstyle": "-", "linewidth": 0.6},
        )
        axes[1].set_title("(b) hysteresis along the path", pad=12)
        axes[1].plot([], [], color="0.3", linestyle="-", label="Nordmark map")
        axes[1].plot([], [], color="0.3", linestyle="--", label="Eq. (1)")
        axes[1].legend(loc="upper right")
        label(axes[1].xaxis, "drive frequency", "Hz")
        label(axes[1].yaxis, "1 - F$_m$/F$_g$", "%")
    crossed = sorted({leaf.period(f, tau) for f in path.tolist()})
    holds = max(zero) < 1e-9 and all(grows.values())
    return Claim(
        holds=holds,
        table=table,
        figure=figure,
        numbers={
            "bands": ratios,
            "crossed": crossed,
            "largest_at_upper_edge": max(zero),
            "grows": grows,
            "alpha": [alpha[0], alpha[-1]],
            "gamma": [gamma[0], gamma[-1]],
        },
        sentence=(
            f"From 19.6 to 23.8 Hz the experiment crosses the bands m = {crossed[0]} to {crossed[-1]}: "
            f"alpha from {alpha[0]:.2f} to {alpha[-1]:.2f}, gamma from {gamma[0]:.3f} to {gamma[-1]:.3f}; "
            "in each of p3 to p11 the hysteresis is zero at the upper edge and "
            f"{'grows' if all(grows.values()) else 'does not always grow'} towards the lower."
        ),
    )


# d --------------------------------------------------------------------------------------------------------


def springs(scene: Scene) -> dict[str, tuple[Scene, ModalModel | None]]:
    """Springs and contact laws of the comparison; None for Eq. (1)."""
    middle = frequencies_of(scene)[len(frequencies_of(scene)) // 2]
    bare = bare_cantilever(scene, middle)
    heavy = with_mass_ratio(scene.replace({"spring.kind": "cantilever"}), 0.5, middle)
    u, leaf, loaded = model_of(scene), model_of(bare), model_of(heavy)

    def law(name: str, of: Scene = scene) -> Scene:
        return of.replace({"contact.law": name})

    return {
        "Eq. (1), Newton": (scene, None),
        "folded U, linear": (law("linear"), u),
        "folded U, Hertz": (law("hertz"), u),
        "folded U, Newton": (law("newton"), u),
        "bare cantilever, Hertz": (bare, leaf),
        "heavy-ball cantilever, Hertz": (heavy, loaded),
        "heavy-ball cantilever, Newton": (law("newton", heavy), loaded),
    }


CLOSER = 1.0 / 16.0
"""Part of the born excess at which a disagreement is looked at again: the claim is one about the limit."""


def born_period(
    scene: Scene, model: ModalModel | None, frequency: float, most_cycles: int, part: float = 1.0
) -> int:
    """Period at `part` of the born excess of the scene, 0 for none, -1 if it could not be followed."""
    oscillator = (
        single_mode_oscillator(scene, frequency) if model is None else beam_of(scene, frequency, model)
    )
    strobed = StroboscopicMap(oscillator=oscillator)
    excess = part * scene.scan.born_excess
    try:
        return settle(strobed.at(excess), strobed.at(-excess).steady(), most_cycles=most_cycles).period
    except ContactError:
        return -1


def universality_claim(scene: Scene, quick: bool, workers: int) -> Claim:
    """d: born period against f T."""
    leaf, tau = Leaf.of(scene), scene.single_mode.restitution
    positions = np.linspace(0.802, 0.956, 13 if quick else 55)
    entries = springs(scene)
    jobs = [(name, float(x)) for name in entries for x in positions]

    def job(item: tuple[str, float], part: float = 1.0) -> int:
        name, place = item
        of, model = entries[name]
        period = (
            of.single_mode.free_period_s
            if model is None
            else 2.0
            * math.pi
            / math.sqrt(float(model.omega[0]) ** 2 - 0.25 * float(model.decay_rate[0]) ** 2)
        )
        return born_period(of, model, place / period, 1500 if quick else 3000, part)

    allowed, quarter = {}, {}
    for place in positions.tolist():
        nordmark = leaf.map(place / leaf.free_period, tau)
        m = maximal_period(nordmark)
        allowed[place] = maximal_periods(nordmark)
        edge = band(m, free_period=leaf.free_period, decay_rate=leaf.decay_rate, restitution=tau)
        part = (place / leaf.free_period - edge.lower) / (edge.upper - edge.lower)
        quarter[place] = min(3, max(0, math.floor(4.0 * part)))
    with ThreadPoolExecutor(max_workers=workers) as pool:
        found = list(pool.map(job, jobs))
        again = [
            item
            for item, p in zip(jobs, found, strict=True)
            if quarter[item[1]] == 3 and p not in allowed[item[1]]
        ]
        nearer = dict(zip(again, pool.map(lambda item: job(item, CLOSER), again), strict=True))
    figure, axis = new_figure(width=PAGE, height=0.085)
    numbers: dict[str, Any] = {}
    table: dict[str, list[Any]] = {n: [] for n in ("spring", "f_times_T", "period", "map")}
    for number, name in enumerate(entries):
        mine = [(place, period) for (who, place), period in zip(jobs, found, strict=True) if who == name]
        agree = [period in allowed[place] for place, period in mine]
        by_quarter = [
            [ok for ok, (place, _p) in zip(agree, mine, strict=True) if quarter[place] == q] for q in range(4)
        ]
        exceptions = [
            {"f_times_T": place, "period": period, "closer": nearer[name, place], "map": list(allowed[place])}
            for place, period in mine
            if (name, place) in nearer
        ]
        numbers[name] = {
            "agree": float(np.mean(agree)),
            "agree_by_quarter_of_band": [float(np.mean(q)) if q else None for q in by_quarter],
            "exceptions_in_top_quarter": exceptions,
            "without_period": sum(p == 0 for _x, p in mine),
            "failed": sum(p < 0 for _x, p in mine),
        }
        shift = 0.1 * (number - 0.5 * (len(entries) - 1))
        style = series(number)
        shown = [(x, p) for x, p in mine if 1 < p <= 12]
        axis.plot(
            [x for x, _p in shown],
            [p + shift for _x, p in shown],
            linestyle="none",
            marker=style["marker"],
            color=style["color"],
            markersize=2.6,
            markerfacecolor="none" if style["marker"] not in "xP*" else None,
            markeredgewidth=0.7,
            label=name,
        )
        rest = [x for x, p in mine if not 1 < p <= 12]
        axis.plot(
            rest,
            [1.0 + shift] * len(rest),
            linestyle="none",
            marker=style["marker"],
            color=style["color"],
            markersize=2.6,
            markerfacecolor="none" if style["marker"] not in "xP*" else None,
            markeredgewidth=0.7,
        )
        table["spring"] += [name] * len(mine)
        table["f_times_T"] += [x for x, _p in mine]
        table["period"] += [p for _x, p in mine]
        table["map"] += [" or ".join(map(str, allowed[x])) for x, _p in mine]
    for m in range(2, 13):
        edge = band(m, free_period=leaf.free_period, decay_rate=leaf.decay_rate, restitution=tau)
        left, right = edge.lower * leaf.free_period, edge.upper * leaf.free_period
        axis.fill_between([left, right], m - 0.42, m + 0.42, color="0.88", linewidth=0.0, zorder=0)
    with house_style():
        axis.set_xlim(positions[0] - 0.003, positions[-1] + 0.003)
        axis.set_ylim(0.4, 12.6)
        axis.set_yticks([1, *range(2, 13)], ["other", *(str(m) for m in range(2, 13))])
        label(axis.xaxis, "f T")
        label(axis.yaxis, f"period born at excess {scene.scan.born_excess:g}")
        figure.legend(
            loc="outside lower center", ncols=3, title="grey: bands of the Nordmark map", title_fontsize=7
        )
    unlike = {name: numbers[name]["exceptions_in_top_quarter"] for name in entries}
    wrong = [name for name, some in unlike.items() if any(e["closer"] not in e["map"] for e in some)]
    some_unlike = ", ".join(name for name, some in unlike.items() if some)
    least = min(float(numbers[name]["agree"]) for name in entries)
    failed = sum(int(numbers[name]["failed"]) for name in entries)
    count = sum(len(some) for some in unlike.values())
    top = sum(quarter[place] == 3 for place in positions.tolist()) * len(entries)
    sentence = (
        f"In the quarter of each band next to its upper edge, {top - count} of {top} pairs of frequency and "
        f"spring have the period of the map at excess {scene.scan.born_excess:g}"
    )
    if count:
        closer = (
            f"at a sixteenth of that excess {'not even then: ' + ', '.join(wrong) if wrong else 'all have'}"
        )
        sentence += f" (exceptions: {some_unlike}; {closer})"
    sentence += (
        f". Over whole bands, where secondary bifurcations come first, it is {100 * least:.0f} % or more."
    )
    return Claim(
        holds=None if failed else not wrong,
        table=table,
        figure=figure,
        numbers={**numbers, "closer_excess": CLOSER * scene.scan.born_excess},
        sentence=sentence,
    )


# e --------------------------------------------------------------------------------------------------------


def overdamped(alpha: float, gamma: float = 0.0) -> NordmarkMap:
    """The map with real eigenvalues of the motion without impact and tau = 0."""
    return NordmarkMap(alpha=alpha, gamma=gamma, restitution=0.0, whole_turns=0)


def slow(alpha: float, gamma: float) -> float:
    """l, the larger eigenvalue."""
    return 0.5 * (alpha + math.sqrt(alpha * alpha - 4.0 * gamma))


def window(nordmark: NordmarkMap, period: int) -> tuple[float, float] | None:
    """The rho between which p_m is stable and without a second impact, None if there are none.

    x_0 rises with rho: along it p_m becomes stable once, and meets its second impact once.
    """
    size = slow(nordmark.alpha, nordmark.gamma) ** (2 * period - 2)

    def stable(z: float) -> bool:
        return any(orbit.stable for orbit in maximal_orbits(nordmark, period, size * z))

    def doubled(z: float) -> bool:
        return not any(orbit.admissible for orbit in maximal_orbits(nordmark, period, size * z))

    low, high = (first_true(statement, 1e-4, 1e6) for statement in (stable, doubled))
    return (size * low, size * high) if low < high else None


def first_true(statement: Callable[[float], bool], low: float, high: float) -> float:
    """Where a statement that is false at `low` and true at `high` becomes true, on a logarithmic scale."""
    for _ in range(60):  # halvings of 23: to rounding
        middle = math.sqrt(low * high)
        low, high = (low, middle) if statement(middle) else (middle, high)
    return high


def overlap(alpha: float, gamma: float, period: int) -> float:
    """log of upper end of p_(m+1) over lower end of p_m: above 0 where they coexist."""
    lower, upper = window(overdamped(alpha, gamma), period), window(overdamped(alpha, gamma), period + 1)
    return -1.0 if lower is None or upper is None else math.log(upper[1] / lower[0])


def switch(holds: Callable[[float], bool], low: float, high: float, halvings: int = 16) -> float:
    """Where a statement that is true at `low` and false at `high` changes."""
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return 0.5 * (low + high)


def exponents(
    alpha: float | np.ndarray, gamma: float, rho: np.ndarray, settle_steps: int, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Largest exponents of the map at each rho, and the last 120 x, by carrying one tangent along."""
    x, y = rho.copy(), np.zeros_like(rho)
    a, b = np.ones_like(rho), np.full_like(rho, 0.1)
    total = np.zeros_like(rho)
    kept = []
    for n in range(settle_steps + steps):
        hit = x > 0.0
        root = np.sqrt(np.where(hit, x, 1.0))
        slope = np.where(hit, -0.5 / root, alpha)
        lost = np.where(hit, 0.0, gamma)
        a, b = slope * a + b, -lost * a
        x, y = np.where(hit, -root, alpha * x) + y + rho, -lost * x
        size = np.hypot(a, b)
        a, b = a / size, b / size
        if n >= settle_steps:
            total += np.log(size)
        if n >= settle_steps + steps - 120:
            kept.append(x)
    return total / steps, np.array(kept)


def overdamped_claim(quick: bool) -> Claim:
    """e: windows of p_m, their overlap and the chaos between, for the overdamped map as rho -> 0+."""
    m = 16  # what the limit rho -> 0+ neglects is of the order l^m, 0.2 % here
    small = 0.01
    limits = {}
    for gamma in (0.0, small):
        least = 2.0 * math.sqrt(gamma) + 0.02

        def coexist(alpha: float, gamma: float = gamma) -> bool:
            return overlap(alpha, gamma, m) > 0.0

        def exists(alpha: float, gamma: float = gamma) -> bool:
            return window(overdamped(alpha, gamma), m) is not None

        halvings = 10 if quick else 14
        limits[f"gamma {gamma:g}"] = {
            "overlap_ends_at_alpha": switch(coexist, least, 0.6, halvings) if coexist(least) else None,
            "windows_end_at_alpha": switch(exists, 0.4, 0.95, halvings),
        }
    alphas = np.linspace(0.05, 0.95, 19 if quick else 46)
    count = 60 if quick else 120
    long = (
        (2000, 3000) if quick else (4000, 8000)
    )  # next to a window's end both chaos and its absence are slow
    middles = (np.arange(count) + 0.5) / count
    # one turn of the cascade, far enough down that the limit is reached
    rho = np.minimum(1e-8, alphas**14)[:, None] * alphas[:, None] ** (2.0 * middles)
    each = np.broadcast_to(alphas[:, None], rho.shape)
    part = np.mean(exponents(each, 0.0, rho, *long)[0] > 0.0, axis=1)
    predicted = np.clip(np.log(0.75 / (1.0 - alphas)) / (2.0 * np.log(1.0 / alphas)), 0.0, 1.0)
    predicted[alphas > 2.0 / 3.0] = 1.0
    numbers: dict[str, Any] = {
        "limits": limits,
        "chaotic_part": {f"alpha {a:.3g}": p for a, p in zip(alphas, part, strict=True)},
        "below_1/4": float(part[alphas < 0.25].max()),
        "above_2/3": float(part[alphas > 0.68].min()),
        "largest_difference_from_the_windows": float(np.max(np.abs(part - predicted))),
    }
    figure, axes = new_figure(2, 2, width=PAGE, height=0.105)
    for number, (axis, alpha) in enumerate(zip(axes.flat, (0.20, 0.45, 0.80), strict=False)):
        top = 1e-3
        rho = np.geomspace(top * alpha ** (4 if alpha < 0.7 else 16), top, 150 if quick else 500)
        found, x = exponents(alpha, 0.0, rho, 1000, 2000)
        for chaos, colour in ((False, "#0072B2"), (True, "#D55E00")):
            chosen = (found > 0.0) == chaos
            if not chosen.any():
                continue
            axis.plot(
                np.tile(rho[chosen], x.shape[0]),
                (x[:, chosen] / np.sqrt(rho[chosen])).ravel(),
                linestyle="none",
                marker=".",
                markersize=0.9,
                markeredgewidth=0.0,
                color=colour,
                rasterized=True,
            )
        with house_style():
            axis.set_xscale("log")
            axis.xaxis.set_minor_formatter(NullFormatter())
            regime = ("windows overlap", "chaos between windows", "chaos only")[number]
            axis.set_title(f"({'abc'[number]}) α = {alpha:g}: {regime}")
            label(axis.yaxis, "x / √ρ")
            label(axis.xaxis, "ρ")
    last = axes.flat[3]
    last.plot(alphas, predicted, color="#D55E00", linewidth=1.0, label="outside the windows of p$_m$")
    last.plot(
        alphas, part, color="black", marker="o", markersize=2.2, linestyle="none", label="exponent above 0"
    )
    with house_style():
        for place, name in ((0.25, "1/4"), (2.0 / 3.0, "2/3")):
            last.axvline(place, color="0.6", linewidth=0.6, linestyle="--")
            last.text(place + 0.01, 0.06, name, fontsize=7)
        last.set_title("(d) chaotic part of ln ρ")
        last.legend(loc="upper left")
        label(last.xaxis, "α")
        last.set_ylim(-0.03, 1.05)
    table = {"alpha": alphas.tolist(), "chaotic_part": part.tolist(), "outside_windows": predicted.tolist()}
    found_limits = limits["gamma 0"]
    ends = (found_limits["overlap_ends_at_alpha"] or 0.0, found_limits["windows_end_at_alpha"] or 0.0)
    close = 0.06 if quick else 0.03  # few values of rho
    holds = (
        abs(ends[0] - 0.25) < 0.002
        and abs(ends[1] - 2.0 / 3.0) < 0.002
        and numbers["below_1/4"] == 0.0
        and numbers["above_2/3"] == 1.0
        and numbers["largest_difference_from_the_windows"] < close
    )
    return Claim(
        holds=holds,
        numbers=numbers,
        table=table,
        figure=figure,
        sentence=(
            f"With gamma = 0 the windows of p_{m} and p_{m + 1} overlap for alpha below {ends[0]:.4f}, are "
            f"parted by chaos up to {ends[1]:.4f} and are gone above (1/4 and 2/3); the part of ln rho with "
            "a positive exponent is that outside the windows within "
            f"{numbers['largest_difference_from_the_windows']:.2g}. The period falls by one from "
            "window to window as rho rises: the cascade is reversed."
        ),
    )


def run(scene: Scene, request: Request) -> dict[str, Any]:
    """Compute, store and draw."""
    began = time.perf_counter()
    if scene.drive.kind != "harmonic":
        raise ValueError(f"drive.kind is {scene.drive.kind}; the claims need a harmonic drive")
    quick = request.quick
    names = {"a": "hysteresis", "b": "secondary", "c": "bands", "d": "universality", "e": "overdamped"}
    makers: dict[str, Callable[[], Claim]] = {
        "a": lambda: hysteresis_claim(scene),
        "b": lambda: secondary_claim(scene, quick),
        "c": lambda: bands_claim(scene, quick),
        "d": lambda: universality_claim(scene, quick, request.workers),
        "e": lambda: overdamped_claim(quick),
    }
    claims = {}
    with request.progress("claims", total=len(makers)) as progress:
        for key, make in makers.items():
            claim = make()
            stem = f"{key}_{names[key]}"
            request.record.write_table(stem, claim.table)
            request.record.write_figure(claim.figure, stem)
            claims[key] = claim.as_dict()
            progress.advance()
            print(f"({key}) holds: {claim.holds}. {claim.sentence}", flush=True)
    failed = int(claims["d"]["holds"] is None)
    return {"claims": claims, "failed_cells": failed, "wall_s": time.perf_counter() - began}


def main(argv: Sequence[str] | None = None, *, module: str | None = None) -> int:
    """Run the study from the command line."""
    return run_study(
        "claims", "The letter's other claims, each with the numbers that decide it.", run, argv, module=module
    )


if __name__ == "__main__":
    raise SystemExit(main())
