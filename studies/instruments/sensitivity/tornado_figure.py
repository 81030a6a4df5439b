"""The hysteresis after each change over the hysteresis before it, one panel for each frequency."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from studies.instruments.figures import (
    BLUE,
    NOTE,
    PAGE,
    VERMILION,
    in_house_style,
    label,
    new_figure,
    panel,
    tint,
)

__all__ = ["draw_tornado"]


@in_house_style
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
    for axis in axes.flat[len(frequencies) :]:
        axis.set_visible(False)
    for number, (axis, frequency) in enumerate(zip(axes.flat, frequencies, strict=False)):
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
                way = "raised" if raised else "lowered"
                name = f"{row['parameter']} {way}, {'beam' if model == 'beam' else 'Eq. (1)'}"
                if now is None and then is not None:
                    axis.plot(
                        0.23, place + shift, linestyle="none", marker="x" if raised else "+", markersize=3.5,
                        color=VERMILION if raised else BLUE, clip_on=False, gid=f"{name}: none is left",
                    )  # fmt: skip
                if now is None or then is None or now * then <= 0 or abs(now / then - 1.0) < 1e-9:
                    continue
                axis.barh(
                    place + shift,
                    now / then - 1.0,
                    height,
                    left=1.0,
                    zorder=2,
                    **_look(model, raised),
                    gid=name,
                )
            if row["born_beam"] != base["born_beam"]:
                words = f"p$_{{{row['born_beam']}}}$" if row["born_beam"] else "no period"
                axis.annotate(
                    f"{words} at {row['change']}",
                    (0.99, place),
                    xycoords=("axes fraction", "data"),
                    ha="right",
                    va="center" if not raised else "top",
                    fontsize=NOTE,
                )
        axis.axvline(1.0, color="0.3", linewidth=0.7, zorder=3, gid="no change")
        axis.set_xscale("log")
        axis.set_xlim(0.22, 4.5)
        axis.set_xticks([0.25, 0.5, 1.0, 2.0, 4.0], ["0.25", "0.5", "1", "2", "4"])
        axis.minorticks_off()
        axis.set_yticks(range(len(parameters)), parameters)
        axis.set_ylim(-0.6, len(parameters) - 0.4)
        fold = (
            "none"
            if base["fold_beam"] is None
            else _tex(format(-base["fold_beam"], ".1e"))
        )
        panel(axis, number, f"{frequency:.2f} Hz, p$_{{{base['m']}}}$ ({fold})")
    for axis in axes[-1]:
        label(axis.xaxis, "hysteresis / (hysteresis before)")
    for axis in axes[:, 0]:
        label(axis.yaxis, "what is changed")
    handles: list[Any] = [
        Patch(
            **_look(model, raised),
            label=f"{'raised' if raised else 'lowered'}, {'beam' if model == 'beam' else 'Eq. (1)'}",
        )
        for model in ("beam", "single_mode") for raised in (False, True)
    ]  # fmt: skip
    handles += [
        Line2D([], [], linestyle="none", marker=mark, color=colour, markersize=3.5, label=f"{way}: none left")
        for mark, colour, way in (("+", BLUE, "lowered"), ("x", VERMILION, "raised"))
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=6, columnspacing=1.2)
    return figure


def _look(model: str, raised: bool) -> dict[str, Any]:
    """Fill and hatch by description and direction: a grey copy tells them apart."""
    colour = VERMILION if raised else BLUE
    if model == "beam":
        return {"facecolor": tint(colour, 0.4) if raised else colour, "edgecolor": colour, "linewidth": 0.6}
    hatch = "\\\\" * 3 if raised else "/" * 6
    return {"facecolor": "white", "edgecolor": colour, "linewidth": 0.6, "hatch": hatch}


def _tex(text: str) -> str:
    """1.2e-04 as a power of ten."""
    if "e" not in text:
        return text
    digits, power = text.split("e")
    return f"{digits}·10$^{{{int(power)}}}$"
