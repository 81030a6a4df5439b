"""
Matrices of your own
====================

Mass and stiffness matrices of any program make a modal model.  Here scikit-fem makes them for a steel frame
with clamped feet.  The base is shaken sideways.  The roof can hit a stop on the right, and the left leg can
hit one on the left.  Each point has a name and a row of numbers.  The row
times the unknowns is the displacement of the point.
"""

# %%
# The steel is 4 mm thick in the plane of the frame and 20 mm wide across it.
import matplotlib.pyplot as plt
import numpy as np
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, MeshQuad
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity, plane_stress
from skfem.visuals.matplotlib import draw

from beam import ModalModel
from contact import HarmonicDrive, ImpactOscillator, LinearContact, Stop, simulate

lines = np.concatenate([[0], np.linspace(0.004, 0.196, 13), [0.2]])
mesh = MeshQuad.init_tensor(lines, lines)
x, y = mesh.p[:, mesh.t].mean(axis=1)
mesh = mesh.restrict(np.flatnonzero((y > 0.196) | (abs(x - 0.1) > 0.096)))
basis = Basis(mesh, ElementVector(ElementQuad2()))
moving = np.setdiff1d(np.arange(basis.N), basis.get_dofs(lambda x: x[1] < 1e-9))
K = 0.02 * linear_elasticity(*plane_stress(210e9, 0.3)).assemble(basis)[moving][:, moving]
M = 0.02 * 7850 * BilinearForm(lambda u, v, _: dot(u, v)).assemble(basis)[moving][:, moving]

# %%
# `moving` leaves out the unknowns of the clamped feet.  Each row has a one at the unknown of its point.
sideways = np.isin(moving, basis.split_indices()[0])
places = {"roof": (0.2, 0.2), "leg": (0, lines[7])}
nodes = {name: np.argmin(np.hypot(*(mesh.p - np.array([place]).T))) for name, place in places.items()}
points = {name: 1.0 * (moving == basis.nodal_dofs[0, node]) for name, node in nodes.items()}
model = ModalModel.from_matrices(M, K, C=4e-5 * K, points=points, base=1.0 * sideways, modes=8)
print("natural frequencies (Hz):", *model.frequencies_hz.round(1))

# %%
# The drive frequency is 80 % of the lowest natural frequency.  Each touch has the number of its stop.
law, drive = LinearContact(stiffness=1e6), HarmonicDrive(frequency=63, amplitude=4e-4)
stops = Stop(gap=0.5e-3, law=law, at="roof"), Stop(gap=0.2e-3, law=law, at="leg", side=-1)
frame, times = ImpactOscillator(model=model, stops=stops, drive=drive), np.linspace(0, 0.16, 4001)
motion = simulate(frame, duration=0.16, times=times)
print("stops that are touched, in their order:", *motion.impacts.stop)

# %%
# Triangles mark the stops beside the frame, and dashed lines mark their gaps.
figure, (left, right) = plt.subplots(1, 2, figsize=(7, 4.4), layout="constrained", width_ratios=(2, 3))
draw(mesh.scaled(1e3), ax=left).set(aspect="equal", xlabel="mm")
for stop, colour, mark, at in zip(stops, ("#D55E00", "#0072B2"), "<>", ((207, 198), (-7, 100)), strict=True):
    left.plot(*at, mark, color=colour, markersize=10)
    left.text(0.63 * at[0] + 32, 0.9 * at[1], stop.at, color=colour, ha="center")
    right.plot(1e3 * times, 1e3 * motion.displacement @ model.points[stop.at].row, color=colour)
    right.axhline(1e3 * stop.side * stop.gap, color=colour, linestyle="--")
right.set(xlabel="time (ms)", ylabel="displacement (mm)", xlim=(0, 160))
plt.show()
