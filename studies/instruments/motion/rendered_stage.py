"""Pictures by VTK, drawn off the screen with the parallel projection of `view`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from beam.spring_mesh import BALL
from studies.instruments.motion.bench import FACES, Box
from studies.instruments.motion.scene_bodies import Bodies, Colours, Moment
from studies.instruments.motion.view import View
from studies.instruments.off_screen import prepare_off_screen

__all__ = ["RenderedStage"]

FAR = 1.0
"""Distance of the viewer [m]; without perspective it only has to be outside."""


class RenderedStage:
    """A window that is never shown; bodies keep their meshes and move. Only where `off_screen.can_render`."""

    def __init__(self, bodies: Bodies, view: View) -> None:
        prepare_off_screen()
        import pyvista

        self._bodies = bodies
        size = [view.width, view.height]
        plotter: Any = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
        self._plotter = plotter
        plotter.set_background(Colours.sky)
        faces: Any = bodies.faces
        self._strip: Any = pyvista.PolyData.from_regular_faces(bodies.points.copy(), faces)
        colours = np.array(Colours.part)[bodies.part]
        self._strip.cell_data["colour"] = np.round(255.0 * colours).astype(np.uint8)
        matt = {"ambient": 0.45, "diffuse": 0.6, "specular": 0.1}
        plotter.add_mesh(self._strip, scalars="colour", rgb=True, **matt)
        sphere = pyvista.Sphere(
            radius=bodies.ball_radius, center=bodies.ball_centre, theta_resolution=48, phi_resolution=48
        )
        shiny = {"ambient": 0.4, "diffuse": 0.6, "specular": 0.4, "specular_power": 30.0}
        self._ball = plotter.add_mesh(sphere, color=Colours.part[BALL], smooth_shading=True, **shiny)
        bench = bodies.bench
        grey = {"color": Colours.holder, **matt}
        self._still = [plotter.add_mesh(_mesh(box), **grey) for box in bench.clamps]
        self._stop = [plotter.add_mesh(_mesh(box), **grey) for box in bench.stop]
        table = plotter.add_mesh(_mesh(bench.table), color=Colours.table, ambient=1.0, diffuse=0.0)
        self._still.append(table)
        net = pyvista.PolyData()
        raised = bench.lines + np.array([0.0, 0.0, 1e-4])
        net.points = raised.reshape(-1, 3)
        net.lines = np.insert(np.arange(2 * len(raised)).reshape(-1, 2), 0, 2, axis=1).ravel()
        self._still.append(plotter.add_mesh(net, color=Colours.lines, line_width=1.0, lighting=False))
        _light(plotter, view)
        _look(plotter, view)
        plotter.show(auto_close=False)

    def picture(self, moment: Moment) -> NDArray[np.uint8]:
        self._strip.points = self._bodies.points + moment.points + moment.base
        self._ball.position = tuple(moment.ball + moment.base)
        for actor in self._still:
            actor.position = tuple(moment.base)
        for actor in self._stop:
            actor.position = tuple(moment.base + moment.pressed)
        for plate in self._stop[:1]:
            plate.prop.color = Colours.flash if moment.flash else Colours.plate
            plate.prop.ambient = 0.85 if moment.flash else 0.45
            plate.prop.diffuse = 0.15 if moment.flash else 0.6
        self._plotter.render()
        picture: NDArray[np.uint8] = np.asarray(self._plotter.screenshot(return_img=True), dtype=np.uint8)
        return picture[..., :3]

    def close(self) -> None:
        self._plotter.close()


def _mesh(box: Box) -> Any:
    import pyvista

    return pyvista.PolyData.from_regular_faces(box.corners, FACES)


def _light(plotter: Any, view: View) -> None:
    import pyvista

    place = view.centre + FAR * (view.towards - 0.9 * view.up - 0.4 * view.right)
    plotter.add_light(pyvista.Light(position=tuple(place), focal_point=tuple(view.centre), intensity=1.0))


def _look(plotter: Any, view: View) -> None:
    camera = plotter.camera
    camera.position = tuple(view.centre + FAR * view.towards)
    camera.focal_point = tuple(view.centre)
    camera.up = tuple(view.up)
    camera.parallel_projection = True
    camera.parallel_scale = 0.5 * view.height / view.scale
    camera.clipping_range = (0.1 * FAR, 2.0 * FAR)
