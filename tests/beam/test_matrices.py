"""Modal models of matrices that others assembled: beams by scikit-fem's Hermite elements, full matrices."""

import numpy as np
import pytest
import skfem as sk
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array

import beam

EI, MASS, LENGTH = 2.0, 0.3, 0.5


@sk.BilinearForm
def bending(w, v, p):
    return EI * w.hess[0, 0] * v.hess[0, 0]


@sk.BilinearForm
def inertia(w, v, p):
    return MASS * w * v


def straight(elements: int, held: int) -> tuple[csr_array, csr_array, np.ndarray]:
    """M, K over (w, w') of each node but the first `held` unknowns, and the base's motion across."""
    basis = sk.Basis(sk.MeshLine(np.linspace(0.0, LENGTH, elements + 1)), sk.ElementLineHermite())
    kept = np.arange(held, basis.N)
    m, k = (csr_array(form.assemble(basis))[kept][:, kept] for form in (inertia, bending))
    return m, k, (np.arange(basis.N) % 2 == 0)[kept] * 1.0


def test_a_cantilever_has_the_textbook_roots_and_statics() -> None:
    m, k, base = straight(100, 2)
    tip, middle = np.eye(200)[198], csr_array(np.eye(200)[[98]])
    model = beam.ModalModel.from_matrices(m, k, points={"tip": tip, "middle": middle}, base=base, modes=4)
    roots = np.array([1.87510406871196, 4.69409113297417, 7.85475743823761, 10.9955407348755])
    np.testing.assert_allclose(model.omega, (roots / LENGTH) ** 2 * np.sqrt(EI / MASS), rtol=1e-6)
    np.testing.assert_allclose(model.phi, 2.0 / np.sqrt(MASS * LENGTH), rtol=1e-6)
    assert model.static_compliance == pytest.approx(LENGTH**3 / (3.0 * EI), rel=1e-8)
    half = model.points["middle"].static_compliance
    assert half == pytest.approx((0.5 * LENGTH) ** 3 / (3.0 * EI), rel=1e-8)
    assert not model.decay_rate.any()


@pytest.mark.parametrize("elements", [30, 460])  # by LAPACK and by ARPACK
def test_a_free_beam_has_two_rigid_motions(elements: int) -> None:
    m, k, base = straight(elements, 0)
    tip = np.eye(base.size)[-2]
    model = beam.ModalModel.from_matrices(m, k, points={"end": tip}, base=base, modes=5)
    assert (model.omega == 0.0).tolist() == [True, True, False, False, False]
    roots = np.array([4.73004074486270, 7.85320462409584, 10.9956078380017])
    np.testing.assert_allclose(model.omega[2:], (roots / LENGTH) ** 2 * np.sqrt(EI / MASS), rtol=2e-5)
    rigid = model.phi[:2]
    assert rigid @ rigid == pytest.approx(4.0 / (MASS * LENGTH), rel=1e-7)  # 1/m + (L/2)^2 / (m L^2/12)
    assert model.participation @ model.participation == pytest.approx(MASS * LENGTH, rel=1e-8)
    assert model.static_compliance is None and set(model.points) == {"tip", "end"}


def test_all_modes_of_full_matrices_are_those_of_lapack_and_obey_the_sums() -> None:
    rng = np.random.default_rng(8)
    roots, (drive, tip) = rng.normal(size=(2, 24, 24)), rng.normal(size=(2, 24))
    m, k = roots @ roots.transpose(0, 2, 1) + np.eye(24)
    model = beam.ModalModel.from_matrices(m, csr_array(k), points={"tip": tip}, base=drive, modes=24)
    squares, x = eigh(k, m)
    np.testing.assert_allclose(model.omega**2, squares, rtol=1e-10)
    np.testing.assert_allclose(model.phi, np.abs(tip @ x), rtol=1e-8)
    assert model.static_compliance == pytest.approx(np.sum(model.phi**2 / model.omega**2), rel=1e-10)
    assert 1.0 / model.tip_mass == pytest.approx(model.phi @ model.phi, rel=1e-10)
    assert model.participation @ model.phi == pytest.approx(drive @ tip, rel=1e-8)
    assert model.participation @ model.participation == pytest.approx(drive @ m @ drive, rel=1e-10)


def test_damping_is_refused_unless_the_modes_diagonalise_it() -> None:
    m, k, base = straight(10, 2)
    given = dict(points={"tip": np.eye(20)[18]}, base=base, modes=6)
    model = beam.ModalModel.from_matrices(m, k, C=0.4 * m + 1e-5 * k, **given)
    np.testing.assert_allclose(model.decay_rate, 0.4 + 1e-5 * model.omega**2, rtol=1e-8)
    with pytest.raises(ValueError, match="C couples the modes"):
        beam.ModalModel.from_matrices(m, k, C=diags_array(np.arange(20.0)), **given)


def test_damping_chooses_among_modes_of_equal_frequency() -> None:
    """Two equal springs across each other, with dashpots along the diagonals."""
    damper = [[2.0, 1.0], [1.0, 2.0]]
    given = dict(points={"tip": [1.0, 0.0]}, base=[1.0, 0.0], modes=2)
    model = beam.ModalModel.from_matrices(np.eye(2), 9.0 * np.eye(2), C=damper, **given)
    np.testing.assert_allclose(model.decay_rate, [1.0, 3.0], rtol=1e-12)
    np.testing.assert_allclose(model.phi, np.sqrt(0.5), rtol=1e-12)


def test_damping_sees_all_modes_of_a_frequency_and_leaves_rigid_motions_alone() -> None:
    """Two equal beams under C = [[0.2, 0.1], [0.1, 0.2]] M, whose third mode is one of two; C = beta K."""
    m, k, base = straight(20, 2)
    pair = [np.kron(np.eye(2), matrix.toarray()) for matrix in (m, k)]
    given = dict(points={"tip": np.eye(80)[38]}, base=np.tile(base, 2), modes=3)
    model = beam.ModalModel.from_matrices(*pair, C=np.kron([[0.2, 0.1], [0.1, 0.2]], m.toarray()), **given)
    np.testing.assert_allclose(model.decay_rate, [0.1, 0.3, 0.1], rtol=1e-9)
    m, k, base = straight(20, 0)
    free = beam.ModalModel.from_matrices(m, k, points={"tip": np.eye(42)[-2]}, base=base, modes=4, C=1e-3 * k)
    np.testing.assert_allclose(free.decay_rate, 1e-3 * free.omega**2, rtol=1e-8)
