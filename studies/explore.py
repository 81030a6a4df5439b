"""A window with sliders for drive frequency, excess and restitution.

For map, Eq. (1), Eq. (1) with two parameters (the rebound law of the beam) or beam, while one drags: the tip
over time with its impacts, the strobe points, and the orbit diagram around the present excess F/F_g - 1,
raised (dots), then lowered (rings). A motion with impacts is carried along, as on the shaker, to its fold; a
click on the description ends it. Restitution is that of Newton's law.

Run:     python -m studies explore [--scene FILE.toml] [--set key=value]     on a display
Writes:  nothing
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.backend_bases import FigureManagerBase
from matplotlib.figure import Figure
from matplotlib.widgets import RadioButtons, Slider

from beam import InvalidValue, ModalModel, Refusal
from contact import ContactError, ImpactKind, StrobedMap, StroboscopicMap, plots, simulate
from contact.orbits import settle
from studies.physics.descriptions import BELOW, TITLES, strobed_at, up_and_down
from studies.physics.least_model import least_modes, middle_of
from studies.physics.one_mode import with_restitution
from studies.shell.executors import say
from studies.shell.options import Parser, add_scene, tool
from studies.shell.plotting import DOWN, EXCESS, GUIDE, INCH, PAGE, UP, house_style, points
from studies.shell.programs import COMMAND, needs
from studies.shell.scene import Scene, harmonic, model_of, one_stop, read_scene

KINDS = {"map": (61, 600), "Eq. (1)": (41, 600), "two parameters": (41, 600), "beam": (21, 200)}
"""Amplitudes of the diagram, drive periods at each: the letter's spring loses e^-16 of a motion in 200."""

NAMES = dict(zip(KINDS, TITLES, strict=True))

REACH, SPAN, TRACE, SAMPLES, STROBES, SETTLE = 0.03, 0.01, 12, 2401, 64, 600
"""Excess of slider and diagram; periods, samples of a trace; strobes; periods to settle."""


@lru_cache(maxsize=4)
def modes_of_beam(scene: Scene) -> ModalModel:
    """The least number of modes, which is printed."""
    scene, sentence = least_modes(scene, {"fold": 0.07})
    say(sentence)
    return model_of(scene)


@lru_cache(maxsize=64)
def described(scene: Scene, kind: str, frequency: float, restitution: float) -> StrobedMap[Any]:
    """The description at a drive frequency [Hz]."""
    at = scene.replace({f"{key}restitution": restitution for key in ("single_mode.", "contact.local_")})
    model = modes_of_beam(scene) if kind in ("two parameters", "beam") else None
    return strobed_at(NAMES[kind], at, frequency, model)


def motion_of(here: StrobedMap[Any], end: Any) -> tuple[Any, float, tuple[np.ndarray, ...]]:
    """State before an impact, stop [mm]; times [periods], tip [mm], impacts, tip and velocity at strobes."""
    end = here.orbit(end, int(np.argmax(here.orbit(end, STROBES).impacts))).end
    if not isinstance(here, StroboscopicMap):
        x, y = here.orbit(end, STROBES).points.T
        return end, 0.0, (np.arange(TRACE), x[:TRACE], np.flatnonzero(x[:TRACE] > 0.0), x, y)
    end, time, tip = replace(end, time=0.0), np.linspace(0.0, TRACE, SAMPLES), here.oscillator.tip
    run = simulate(here.oscillator, end, periods=STROBES, times=time * here.period)
    hits = run.impacts.start[run.impacts.kind == ImpactKind.IMPACT] / here.period
    strobes = 1e3 * tip(run.strobe_displacement), tip(run.strobe_velocity)
    return end, 1e3 * here.scale, (time, 1e3 * tip(run.displacement), hits[hits < TRACE], *strobes)


class Window:
    """Sliders, buttons and three panels on a figure; the state of the motion, None if it has no impacts."""

    def __init__(self, scene: Scene, figure: Figure) -> None:
        self.scene, self.figure, self.state = scene, figure, None
        wide, tall = (3, 5, 5), (9, 9, 1, 1, 1)
        self.axes = figure.subplot_mosaic("ktt;kpd;.ff;.ee;.rr", width_ratios=wide, height_ratios=tall)
        figure.subplots_adjust(left=0.02, right=0.9, bottom=0.03, top=0.94, hspace=0.65, wspace=0.5)
        drives, tau = scene.drive.frequencies_hz, scene.single_mode.restitution
        low, high, (f, e, r) = 0.9 * min(drives), 1.05 * max(drives), (self.axes[name] for name in "fer")
        self.sliders = (
            Slider(f, "frequency (Hz)", low, high, valinit=middle_of(scene), valfmt="%.2f Hz"),
            Slider(e, EXCESS, -REACH, REACH, valinit=-BELOW, valfmt="%+.5f"),
            Slider(r, "restitution", 0.0, 1.0, valinit=tau, valfmt="%.3f"),
        )
        self.kind = RadioButtons(self.axes["k"], list(KINDS), active=1)
        for slider in self.sliders:
            slider.on_changed(self.update)
        self.kind.on_clicked(partial(self.update, anew=True))
        self.update(anew=True)

    def update(self, _: object = None, *, anew: bool = False) -> None:
        """Let the motion go over to where the sliders stand, and draw, or say in the title why not."""
        kind, (frequency, excess, restitution) = self.kind.value_selected, (one.val for one in self.sliders)
        law = {"beam": self.scene.contact.law, "two parameters": ""}.get(kind, "newton")
        self.axes["r"].set_visible(law == "newton")
        trace, plane, diagram = (self.axes[name] for name in "tpd")
        try:
            strobed = described(self.scene, kind, round(frequency, 2), restitution)
            here, quiet = strobed.at(excess), strobed.at(excess if excess < 0.0 else BELOW).steady()
            found = settle(here, quiet if anew or self.state is None else self.state, most_cycles=SETTLE)
            end, stop, (time, tip, hits, x, y) = motion_of(here, found.end)
            self.state = end if found.impacts else None
            count, cycles = KINDS[kind]
            observe = strobed.tip if isinstance(strobed, StroboscopicMap) else lambda points: points[:, 0]
            values = excess + np.linspace(-SPAN, SPAN, count)
            scans = up_and_down(strobed, values, observe=observe, settle_cycles=cycles, early=False)
            words = f"period {found.m}" if found.m else "no period up to 64"
        except (ContactError, Refusal) as error:
            self.state, words = None, str(error)
        else:
            at, rate, scale = ("x", "y", 1.0) if kind == "map" else ("tip (mm)", "velocity (m/s)", 1e3)
            words_of = (("drive periods", at), (at, rate), (EXCESS, at))
            for panel, (x_word, y_word) in zip((trace, plane, diagram), words_of, strict=True):
                panel.clear()
                panel.set(xlabel=x_word, ylabel=y_word)
            trace.plot(time, tip, color="black")
            trace.plot(hits, np.full(hits.size, stop), **points(2))
            trace.axhline(stop, **GUIDE)
            plane.plot(x, y, **points(0))
            for way, look in (("up", UP), ("down", DOWN)):
                one = scans[way]
                plots.strobes(diagram, one.excess, scale * one.points, one.m > 0, **look)
            diagram.axvline(excess, **GUIDE)
        trace.set_title(words, loc="left", wrap=True)
        self.figure.canvas.draw_idle()


def explore(given: Any) -> tuple[str, dict[str, object]]:
    """Show the window until it is closed."""
    scene, sentence = with_restitution(harmonic(one_stop(read_scene(given.scene, given.overrides))))
    say(sentence)
    try:
        figure = plt.figure(figsize=(PAGE / INCH, 0.75 * PAGE / INCH), dpi=140)
        if type(figure.canvas.manager) is FigureManagerBase:
            raise ImportError("matplotlib found none")
    except (ImportError, RuntimeError) as error:  # the second where a web page needs another package
        lack = "a window needs a display, and a toolkit such as python3-tk"
        if getattr(error.__cause__ or error, "name", None) == "tornado":
            lack = needs(f"matplotlib's {matplotlib.get_backend()}", "tornado")
        raise InvalidValue(f"{lack}: {error}") from error
    with house_style():
        window = Window(scene, figure)
        with suppress(KeyboardInterrupt):
            plt.show()
    return f"closed at {', '.join(slider.valtext.get_text() for slider in window.sliders)}", {}


def main(argv: Sequence[str] | None = None) -> int:
    """Explore from the command line; returns 0, or 2 for wrong use and where there is no display."""
    parser = Parser(f"{COMMAND} explore", __doc__ or "")
    add_scene(parser)
    return tool(parser, argv, explore)
