"""
Mode shapes of a U
==================

A brass strip is folded into a U, clamped at both ends, and carries a ball at its bend.  In a sway mode both
legs bend to the same side, and the ball moves sideways.  In a breathing mode they bend to opposite sides, and
the ball moves along the legs only.  A base that moves sideways excites the sway modes only.
"""

# %%
# Two functions write files for ParaView.  Here pyvista reads these files back from a temporary folder.
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib import animation, collections

from beam import BRASS, StripSection, Tip, assemble, folded_u, natural_modes, write_mode_motion, write_modes

strip, tip = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3), Tip(mass=4e-3)
modes = natural_modes(assemble(folded_u(leg_length=0.13, bend_radius=7.5e-3, section=strip, tip=tip)), 6)
with TemporaryDirectory() as folder:
    shapes = pyvista.read(write_modes(Path(folder) / "modes.vtu", modes, largest=6e-3, ball_radius=3e-3))
    files = write_mode_motion(Path(folder) / "sway.pvd", modes, 0, largest=15e-3, ball_radius=3e-3)
    frames = [pyvista.read(file) for file in files[1:]]

# %%
# The file holds each shape as vectors.  Sway is drawn at twice the size of breathing, so that no legs cross.
plotter = pyvista.Plotter(shape=(2, 3), window_size=(1200, 640), border=False)
for number, (name, moves) in enumerate(zip(shapes.point_data.keys(), modes.coupled, strict=True)):
    plotter.subplot(number % 2, number // 2)
    plotter.add_mesh(shapes, color="#DDDDDD", opacity=0.4)
    plotter.add_mesh(shapes.warp_by_vector(name, factor=1 + moves), color="#D55E00" if moves else "#0072B2")
    print(words := f"{'sway' if moves else 'breathing'}, {modes.frequencies_hz[number]:.1f} Hz")
    plotter.add_text(words, font_size=11, position="upper_edge")
    plotter.view_vector((-0.5, 0.45, 0.75), (0, 1, 0))
    plotter.camera.zoom(1.2)
plotter.show()

# %%
# The film shows the lowest mode.  The farthest faces are drawn first; those towards the viewer are bright.
view = np.array([[0.83, 0, 0.55], [-0.23, 0.91, 0.34], [-0.5, -0.41, 0.76]])  # rightwards, up, to the viewer


def draw(number):
    surface = frames[number].extract_surface(algorithm="dataset_surface").triangulate().compute_normals()
    corners = 1e3 * surface.points[surface.regular_faces] @ view.T
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    drawn.set_verts(corners[order, :, :2])
    drawn.set_facecolor(plt.colormaps["copper"](0.4 + 0.6 * np.abs(surface["Normals"] @ view[2]))[order])


figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
drawn = axes.add_collection(collections.PolyCollection([], edgecolors="face", linewidths=0.3))
axes.set(xlim=(-10, 125), ylim=(-60, 15), aspect="equal", yticks=[], xlabel="mm, 30 times slower")
draw(0)
film = animation.FuncAnimation(figure, draw, frames=len(frames), interval=50)
plt.show()
