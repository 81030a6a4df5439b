"""The hysteresis after each change over the hysteresis before it, one panel for each frequency."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from studies.instruments.figures import PAGE, house_style, new_figure

__all__ = ["draw_tornado"]


def draw_tornado(rows: Sequence[Mapping[str, Any]]) -> Any:
    """The fold after a change over the fold without it, one panel for each frequency."""
    frequencies = sorted({row["frequency_hz"] for row in rows})
    parameters = list(dict.fromkeys(row["parameter"] for row in rows if row["parameter"] != "none"))[::-1]
    columns = min(3, len(frequencies))
    lines = math.ceil(len(frequencies) / columns)
    figure, axes = new_figure(
        lines,
        columns,
        width=PAGE,
        height=(0.016 + 0.0044 * len(parameters)) * lines + 0.012,
        squeeze=False,
        sharey=True,
        sharex=True,
    )
    with house_style():
        for axis in axes.flat[len(frequencies) :]:
            axis.set_visible(False)
        for panel, (axis, frequency) in enumerate(zip(axes.flat, frequencies, strict=False)):
            here = [row for row in rows if row["frequency_hz"] == frequency]
            base = next(row for row in here if row["parameter"] == "none")
            for row in here:
                if row["parameter"] == "none":
                    continue
                place, raised = parameters.index(row["parameter"]), row["sign"] > 0
                for model, height, shift in (
                    ("beam", 0.23, 0.27 if raised else 0.03),
                    ("single_mode", 0.2, -0.24),
                ):
                    now, then = row[f"fold_{model}"], base[f"fold_{model}"]
                    if now is None and then is not None:
                        axis.plot(
                            0.23,
                            place + shift,
                            marker="x",
                            markersize=3,
                            color="#D55E00" if raised else "#0072B2",
                            clip_on=False,
                        )
                    if now is None or then is None or now * then <= 0 or abs(now / then - 1.0) < 1e-9:
                        continue
                    axis.barh(
                        place + shift,
                        now / then - 1.0,
                        height,
                        left=1.0,
                        zorder=2,
                        color=("#D55E00" if raised else "#0072B2") if model == "beam" else "white",
                        edgecolor="#D55E00" if raised else "#0072B2",
                        linewidth=0.6,
                        hatch=None if model == "beam" else "//////",
                    )
                if row["born_beam"] != base["born_beam"]:
                    words = f"p$_{{{row['born_beam']}}}$" if row["born_beam"] else "no period"
                    axis.annotate(
                        f"{words} at {row['change']}",
                        (0.99, place),
                        xycoords=("axes fraction", "data"),
                        ha="right",
                        va="center" if not raised else "top",
                        fontsize=6,
                    )
            axis.axvline(1.0, color="0.3", linewidth=0.7, zorder=3)
            axis.set_xscale("log")
            axis.set_xlim(0.22, 4.5)
            axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["0.25", "0.5", "1", "2", "4"])
            axis.minorticks_off()
            axis.set_yticks(range(len(parameters)), parameters)
            axis.set_ylim(-0.6, len(parameters) - 0.4)
            fold = (
                "no hysteresis"
                if base["fold_beam"] is None
                else f"hysteresis {_tex(format(-base['fold_beam'], '.1e'))}"
            )
            axis.set_title(
                f"({chr(ord('a') + panel)}) {frequency:.2f} Hz, p$_{{{base['m']}}}$, {fold}",
                fontsize=7,
            )
        figure.supxlabel("hysteresis after the change / before it (×: none is left)")
        from matplotlib.patches import Patch

        handles = [
            Patch(facecolor="#0072B2", label="lowered, beam"),
            Patch(facecolor="#D55E00", label="raised, beam"),
            Patch(facecolor="white", edgecolor="#0072B2", hatch="//////", label="lowered, Eq. (1)"),
            Patch(facecolor="white", edgecolor="#D55E00", hatch="//////", label="raised, Eq. (1)"),
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=4)
    return figure


def _tex(text: str) -> str:
    """1.2e-04 as a power of ten."""
    if "e" not in text:
        return text
    digits, power = text.split("e")
    return f"{digits}·10$^{{{int(power)}}}$"
