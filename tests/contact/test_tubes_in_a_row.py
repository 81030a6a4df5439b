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

MIDDLES, GAP, STIFFNESS, FORCE = ("one", "two", "three"), 1e-3, 1e8, 1e6
DEVOGE = [0.0164264176874, 0.0111626966324, 0.00588734022575]
DEVOGE += [0.0254153737301, 0.0441198407461, 0.104549304707]
CENTRAL = [0.0164294825672, 0.0111676958599, 0.00589756727752]
CENTRAL += [0.025415803242, 0.0442640030056, 0.104582587323]
"""Displacements [m] and velocities [m/s] of the middles at 1 s, printed for two schemes with steps of 2e-4 s."""


@sk.BilinearForm
def bending(w, v, p):
    return w.hess[0, 0] * v.hess[0, 0]


@sk.BilinearForm
def inertia(w, v, p):
    return w * v


def column(own: float, beside: float) -> np.ndarray:
    """Stiffness of five free nodes in a row, as the first, third and fifth feel it."""
    whole = own * np.eye(5) + beside * (np.eye(5, k=1) + np.eye(5, k=-1))
    return np.linalg.inv(np.linalg.inv(whole)[::2, ::2])


@pytest.fixture(scope="module")
def tubes() -> ImpactOscillator:
    with pytest.warns(UserWarning, match="speed of sound"):
        material = Material(youngs_modulus=1e10, poissons_ratio=0.3, density=1e8)
    tube = BeamSection.tube(material=material, outer=0.2, inner=0.18)
    basis = sk.Basis(sk.MeshLine(np.linspace(0.0, 1.0, 11)), sk.ElementLineHermite())
    m = tube.mass_per_length * inertia.assemble(basis).toarray()
    k = np.kron(np.eye(3), tube.bending_stiffness * bending.assemble(basis).toarray())
    unit = np.eye(basis.N)
    for end in (0, basis.N - 2):
        k += 1e6 * tube.axial_stiffness * np.kron(column(2.0, -1.0), np.diag(unit[end]))
        k += 1e6 * tube.bending_stiffness * np.kron(column(8.0, 2.0), np.diag(unit[end + 1]))
    points = dict(zip(MIDDLES, np.kron(np.eye(3), unit[10]), strict=True))
    base = np.tile(unit[::2].sum(axis=0), 3)
    model = ModalModel.from_matrices(np.kron(np.eye(3), m), k, points=points, base=base, modes=15)
    law = LinearContact(stiffness=STIFFNESS)
    stops = tuple(Stop(gap=GAP, law=law, at=pair) for pair in pairwise(MIDDLES))
    return ImpactOscillator(model=model, stops=stops, load=model.load_of({"one": FORCE}))


def contact_forces(tubes: ImpactOscillator, q: np.ndarray) -> np.ndarray:
    return STIFFNESS * np.maximum(tubes.heights(q), 0.0)


def acceleration(tubes: ImpactOscillator, q: np.ndarray) -> np.ndarray:
    rows = [stop.row_in(tubes.model) for stop in tubes.stops]
    return tubes.load - tubes.model.omega**2 * q - contact_forces(tubes, q) @ rows


def middles(tubes: ImpactOscillator, q: np.ndarray, v: np.ndarray) -> list[float]:
    rows = np.array([tubes.model.points[name].row for name in MIDDLES])
    return [*(rows @ q), *(rows @ v)]


def test_the_modes_give_the_digits_printed_for_central_differences(tubes):
    q = v = np.zeros(15)
    for _ in range(5000):
        v = v + 2e-4 * acceleration(tubes, q)
        q = q + 2e-4 * v
    np.testing.assert_allclose(middles(tubes, q, v), CENTRAL, rtol=1e-10)


def test_motion_of_the_tubes_and_impulses_between_them(tubes):
    """Five digits of the printed values, and DOP853."""
    run = simulate(tubes, duration=1.0)
    q, v, touches = run.end.displacement, run.end.velocity, run.impacts
    np.testing.assert_allclose(middles(tubes, q, v), DEVOGE, rtol=1e-5)

    def rates(t, y):
        return np.concatenate((y[15:30], acceleration(tubes, y[:15]), contact_forces(tubes, y[:15])))

    known = solve_ivp(rates, (0.0, 1.0), np.zeros(32), method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    np.testing.assert_allclose(middles(tubes, q, v), middles(tubes, known[:15], known[15:30]), rtol=1e-9)
    impulses = np.bincount(touches.stop, touches.impulse)
    np.testing.assert_allclose(impulses, known[30:], rtol=1e-9)
    # the work of the force is the energy of the modes and of the contacts that are closed
    assert tubes.energy(q, v) + touches.loss.sum() == pytest.approx(tubes.load @ q, rel=1e-12)
    # both contacts are closed at the end, and no impulse was found
    assert sorted(touches.stop[np.isnan(touches.end)]) == [0, 1] and not touches.together.any()
