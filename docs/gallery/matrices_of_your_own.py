"""
Matrices of your own
====================

A mass and a stiffness matrix of any program make a modal model.  Here scikit-fem meshes a portal frame of
steel.  Its base is shaken sideways, its roof can hit a stop on the right, and its left leg one on the left.
Two names are enough to place the stops: each names a row that picks the motion of a point.
"""

# %%
# The strip is 4 mm thick and 20 mm wide.  Its elements are plane, so that the law of plane stress holds.
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
# A row is zero but at the unknowns of its point.  `moving` leaves out the clamped feet of the frame.


def row_at(place):
    """Return the row of the sideways motion of the node at a place."""
    node = np.argmin(np.hypot(*(mesh.p - np.array(place)[:, None])))
    return (np.arange(basis.N) == basis.nodal_dofs[0, node]).astype(float)[moving]


sideways = np.zeros(basis.N)
sideways[basis.split_indices()[0]] = 1
points = {"roof": row_at((0.2, 0.2)), "leg": row_at((0, 0.1))}
model = ModalModel.from_matrices(M, K, C=4e-5 * K, points=points, base=sideways[moving], modes=8)
print("natural frequencies (Hz):", *model.frequencies_hz.round(1))

# %%
# The drive has 80 % of the lowest frequency.  Each touch has the number of its stop.
springy = LinearContact(stiffness=2e5)
stops = Stop(gap=0.5e-3, law=springy, at="roof"), Stop(gap=0.2e-3, law=springy, at="leg", side=-1)
drive, times = HarmonicDrive(frequency=63, amplitude=0.4e-3), np.linspace(0, 0.16, 4001)
motion = simulate(ImpactOscillator(model=model, stops=stops, drive=drive), duration=0.16, times=times)
print("stops that are touched, in their order:", *motion.impacts.stop)

# %%
# Triangles mark the two stops beside the frame, and dashed lines their distances.
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained", width_ratios=(2, 3))
draw(mesh.scaled(1e3), ax=left)
left.set(aspect="equal", xlabel="mm", ylim=(-5, 215))
for number, (name, colour, place) in enumerate((("roof", "#D55E00", (207, 198)), ("leg", "#0072B2", (-7, 100)))):
    left.plot(*place, "<>"[number], color=colour, markersize=10)
    right.plot(1e3 * times, 1e3 * motion.displacement @ model.points[name].row, color=colour, label=name)
    right.axhline(1e3 * stops[number].side * stops[number].gap, color=colour, linestyle="--", linewidth=1)
right.legend()
right.set(xlabel="time (ms)", ylabel="displacement (mm)", xlim=(0, 160))
plt.show()
