"""
Mode shapes of a U
==================

A brass strip is folded into a U, clamped at both ends, and carries a ball at its bend.  In a sway mode both
legs bend to the same side, and the ball moves.  In a breathing mode the legs bend to opposite sides, and the
ball stays at rest.  A base that moves sideways excites the sway modes only.
"""

# %%
# The files are for ParaView.  Here pyvista reads them back, and a temporary folder holds them meanwhile.
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np
import pyvista
from matplotlib.animation import FuncAnimation
from matplotlib.collections import PolyCollection

from beam import BRASS, StripSection, Tip, assemble, folded_u, natural_modes, write_mode_motion, write_modes

strip = StripSection(material=BRASS, width=12e-3, thickness=0.65e-3)
spring = folded_u(leg_length=0.13, bend_radius=7.5e-3, section=strip, tip=Tip(mass=4e-3))
modes = natural_modes(assemble(spring), count=6)
with TemporaryDirectory() as folder:
    grid = pyvista.read(write_modes(Path(folder) / "modes.vtu", modes, largest=0.007, ball_radius=3e-3))
    files = write_mode_motion(Path(folder) / "sway.pvd", modes, 0, largest=0.015, ball_radius=3e-3)
    frames = [pyvista.read(file) for file in files[1:]]

# %%
# Every shape is an array of vectors on the same mesh.
plotter = pyvista.Plotter(shape=(2, 3), window_size=(1200, 720), border=False)
plotter.set_background("white")
for number, (name, coupled) in enumerate(zip(grid.point_data.keys(), modes.coupled, strict=True)):
    plotter.subplot(number % 2, number // 2)
    plotter.add_mesh(grid, color="#DDDDDD", opacity=0.4)
    plotter.add_mesh(grid.warp_by_vector(name), color="#D55E00" if coupled else "#0072B2")
    words = f"{'sway' if coupled else 'breathing'}, {modes.frequencies_hz[number]:.1f} Hz"
    plotter.add_text(words, font_size=11, color="black", position="upper_edge")
    plotter.view_vector((-0.5, 0.45, 0.75), (0, 1, 0))
    plotter.camera.zoom(1.5)
    print(f"{words}: the ball moves by {modes.phi[number]:+.2f}")
plotter.show()

# %%
# The film shows the lowest mode.  The farthest faces are drawn first.
across, up = np.array([[0.83, 0, 0.55], [-0.23, 0.91, 0.34]])


def draw(number):
    """Draw the outer faces of a frame, bright where they look to the viewer."""
    surface = frames[number].extract_surface(algorithm="dataset_surface").triangulate().compute_normals()
    corners, towards = 1e3 * surface.points[surface.regular_faces], np.cross(across, up)
    order = np.argsort(corners.mean(axis=1) @ towards)
    drawn.set_verts((corners @ np.transpose([across, up]))[order])
    drawn.set_facecolor(plt.colormaps["copper"](0.4 + 0.6 * np.abs(surface["Normals"] @ towards))[order])


figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
drawn = axes.add_collection(PolyCollection([], edgecolors="face", linewidths=0.3))
axes.set(xlim=(-15, 130), ylim=(-45, 30), aspect="equal", xlabel="mm")
film = FuncAnimation(figure, draw, frames=len(frames), interval=50)
plt.show()
