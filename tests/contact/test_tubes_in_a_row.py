"""Three tubes in a row, case SDNL105a of Code_Aster (V5.02.105): two elastic contacts that overlap in time.

A constant force pushes the middle of the first tube against the second one, and this against the third.  At
each end the nodes of the tubes stand in a column of beams without mass of 1e15 Pa, 0.1 m apart with a free
node between two of them, as in the mesh of the case.
"""

from itertools import pairwise

import numpy as np
import pytest
import skfem as sk
from scipy.integrate import solve_ivp

from beam import BeamSection, Material, ModalModel
from contact import ImpactOscillator, LinearContact, Stop, simulate

DEVOGE = [16.4264176874, 11.1626966324, 5.88734022575, 25.4153737301, 44.1198407461, 104.549304707]
CENTRAL = [16.4294825672, 11.1676958599, 5.89756727752, 25.415803242, 44.2640030056, 104.582587323]
"""Displacements [mm], velocities [mm/s] of the middles at 1 s, printed for two schemes; steps of 2e-4 s."""
bending = sk.BilinearForm(lambda w, v, p: w.hess[0, 0] * v.hess[0, 0])
inertia = sk.BilinearForm(lambda w, v, p: w * v)


def column(own: float, beside: float) -> np.ndarray:
    """Stiffness of five free nodes in a row, as the first, third and fifth feel it."""
    whole = own * np.eye(5) + beside * (np.eye(5, k=1) + np.eye(5, k=-1))
    return np.linalg.inv(np.linalg.inv(whole)[::2, ::2])


@pytest.mark.filterwarnings("ignore:youngs_modulus:beam.SuspiciousValue")
def test_motion_of_the_tubes_and_impulses_between_them():
    material = Material(youngs_modulus=1e10, poissons_ratio=0.3, density=1e8)
    tube = BeamSection.tube(material=material, outer=0.2, inner=0.18)
    basis = sk.Basis(sk.MeshLine(np.linspace(0.0, 1.0, 11)), sk.ElementLineHermite())
    m = np.kron(np.eye(3), tube.mass_per_length * inertia.assemble(basis).toarray())
    k = np.kron(np.eye(3), tube.bending_stiffness * bending.assemble(basis).toarray())
    unit, names = np.eye(basis.N), ("one", "two", "three")
    for end in (0, basis.N - 2):
        k += 1e6 * tube.axial_stiffness * np.kron(column(2.0, -1.0), np.diag(unit[end]))
        k += 1e6 * tube.bending_stiffness * np.kron(column(8.0, 2.0), np.diag(unit[end + 1]))
    points = dict(zip(names, np.kron(np.eye(3), unit[10]), strict=True))
    model = ModalModel.from_matrices(m, k, points=points, base=np.tile(unit[::2].sum(axis=0), 3), modes=15)
    law, load = LinearContact(stiffness=1e8), model.load_of({"one": 1e6})
    stops = tuple(Stop(gap=1e-3, law=law, at=pair) for pair in pairwise(names))
    tubes, rows = ImpactOscillator(model=model, stops=stops, load=load), [s.row_in(model) for s in stops]

    def rates(t, y):
        forces = law.stiffness * np.maximum(tubes.heights(y[:15]), 0.0)
        return np.concatenate((y[15:30], load - model.omega**2 * y[:15] - forces @ rows, forces))

    def middles(q, v):
        return np.ravel([[1e3 * model.points[name].row @ x for name in names] for x in (q, v)])

    # the modes agree with the case: central differences give its digits
    y = np.zeros(32)
    for _ in range(5000):
        y[15:30] += 2e-4 * rates(0.0, y)[15:30]
        y[:15] += 2e-4 * y[15:30]
    np.testing.assert_allclose(middles(y[:15], y[15:30]), CENTRAL, rtol=1e-10)
    run = simulate(tubes, duration=1.0)
    q, v, touches = run.end.displacement, run.end.velocity, run.impacts
    np.testing.assert_allclose(middles(q, v), DEVOGE, rtol=1e-5)
    known = solve_ivp(rates, (0.0, 1.0), np.zeros(32), method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    np.testing.assert_allclose(middles(q, v), middles(known[:15], known[15:30]), rtol=1e-9)
    np.testing.assert_allclose(np.bincount(touches.stop, touches.impulse), known[30:], rtol=1e-9)
    # the work of the force is the energy of the modes and of the contacts, both closed at the end
    assert tubes.energy(q, v) + touches.loss.sum() == pytest.approx(load @ q, rel=1e-12)
    assert sorted(touches.stop[np.isnan(touches.end)]) == [0, 1] and not touches.together.any()
