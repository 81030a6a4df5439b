"""Modes, statics and masses of points of any linear structure from its matrices M, C and K.

Finite elements, or springs and masses by hand, with n unknowns x relative to the base obey

    M x'' + C x' + K x = -M b z'' + sum r_i F_i,      r_i^T x the motion of point i along its force F_i,

with b the unit rigid motion of the base along the drive. Shapes are normalised, X^T M X = 1, and give

    phi = r^T X,   Gamma = X^T M b,   c_k = (X^T C X)_kk,   compliance r^T K^-1 r,   mass 1/(r^T M^-1 r).

Rounding of K makes an error eps |x|^T |K| |x| of x^T K x; a motion whose energy is no larger has omega = 0.
Sylvester's law of inertia says how many eigenvalues lie below the highest one found: none is missed.
"""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_array, identity, issparse
from scipy.sparse.linalg import ArpackError, splu

from .modes import DENSE_LIMIT, lowest_modes
from .parameters import Array, require, require_array, require_kind, require_whole, shown
from .point import Point

ROUNDING = 1e-10
"""Largest asymmetry of a matrix and residual of a mode, as a part of its terms."""
NO_STRAIN = 1e-15
"""Energy of a rigid motion over the sum of its terms without signs, at most."""
UNCERTAIN = 1e-11
"""Energy of any other mode over that sum, at least: rounding then changes its frequency by 1e-5 at most."""
SAME = 1e-8
"""Frequencies nearer than this part are equal, so that C may choose the shapes among them."""
COUPLED = 1e-6
"""Largest |c_kl| / sqrt(c_kk c_ll) of modes that count as uncoupled by C."""


def modes_of_matrices(
    mass: object, stiffness: object, points: Mapping[str, object], base: object, modes: int, damping: object
) -> tuple[dict[str, Array], dict[str, Point]]:
    """Return the four arrays of a `ModalModel` by name, and its points.

    The arguments are explained at `ModalModel.from_matrices`. The first point is the tip.
    """
    m, k = _symmetric("M", mass, "kg"), _symmetric("K", stiffness, "N/m")
    n, words = m.shape[0], f"is of another size than M, {m.shape[0]} unknowns"
    require(k.shape == m.shape, "K", f"has shape {k.shape} [N/m] and {words}")
    count = require_whole("modes", modes, "modes", high=n, why=", the unknowns")
    require_kind("points", points, Mapping, "a mapping of names to rows")
    require(bool(points), "points", "is empty [no unit]; there must be one at least, the tip")
    rows = {name: _vector(f"points[{name!r}]", row, "[1]", n) for name, row in points.items()}
    omega, x = _modes(k, m, count)
    if damping is None:
        rates = 0.0 * omega
    else:
        c = _symmetric("C", damping, "kg/s")
        require(c.shape == m.shape, "C", f"has shape {c.shape} [kg/s] and {words}")
        wide, most = count, int(np.sum(m.diagonal() > 0.0))
        while wide < most and omega[-1] - omega[count - 1] <= SAME * omega[-1]:
            wide += 1
            omega, x = _modes(k, m, wide)
        rates, x = _decay_rates(c, omega, x)
        omega, rates, x = omega[:count], rates[:count], x[:, :count]
    participation = x.T @ (m @ _vector("base", base, "[1]", n))
    first = rows.get("tip", next(iter(rows.values())))
    leading = np.where(np.abs(first @ x) > ROUNDING * (np.abs(first) @ np.abs(x)), first @ x, participation)
    sign = np.where(leading < 0.0, -1.0, 1.0)
    found = {}
    for name, row in {**rows, "tip": first}.items():
        still = bool(np.all(np.abs(row @ x) <= ROUNDING * (np.abs(row) @ np.abs(x))))
        require(
            not still, f"points[{name!r}]", f"is moved by none of the {count} modes [1]; one must move it"
        )
        compliance = None if np.any(omega == 0.0) else _inverse(k, row)
        inverse = _inverse(m, row)
        known = dict(static_compliance=compliance, mass=inverse and 1.0 / inverse)
        found[name] = Point(row=row @ x * sign, **known)
    arrays = dict(omega=omega, decay_rate=rates, phi=found["tip"].row, participation=participation * sign)
    return arrays, found


def _symmetric(name: str, given: object, unit: str) -> csr_array:
    """Return a square symmetric matrix as a sparse one, or refuse it."""
    words = "a square symmetric matrix"
    if not issparse(given):
        given = require_array(name, given, unit, dimensions=2, words=words)
    matrix = csr_array(given)  # type: ignore[arg-type]
    matrix.data = require_array(name, matrix.data, unit, words=words)
    shape, largest = matrix.shape, abs(matrix).max() if matrix.nnz else 0.0
    require(shape[0] == shape[1], name, f"has shape {shape} [{unit}]; it must be {words}")
    skew = abs(matrix - matrix.T).max() if matrix.nnz else 0.0
    require(skew <= ROUNDING * largest, name, f"has entries {skew:.3g} {unit} apart from their mirror images")
    return csr_array(0.5 * (matrix + matrix.T))


def _vector(name: str, given: object, unit: str, size: int) -> Array:
    """Return a row or column of so many numbers, dense or sparse, as an array."""
    if issparse(given):
        given = given.toarray().ravel()  # type: ignore[attr-defined]
    return require_array(name, given, unit, shape=(size,), words="a row of numbers")


def _negative(matrix: csr_array) -> int:
    """Return the number of negative eigenvalues of a symmetric matrix, from its pivots on the diagonal."""
    options = dict(permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=dict(SymmetricMode=True))
    return int(np.sum(splu(matrix.tocsc(), **options).U.diagonal() < 0.0))


def _modes(k: csr_array, m: csr_array, count: int) -> tuple[Array, Array]:
    """Return omega [rad/s], exactly 0 for rigid motions, and normalised shapes (n, count), lowest first."""
    heavy = m.diagonal()
    lumps = int(np.sum(heavy > 0.0))
    tiny = ROUNDING * heavy.max(initial=0.0) * identity(heavy.size)
    definite = bool(np.all(heavy >= 0.0)) and lumps > 0 and _negative(csr_array(m + tiny)) == 0
    require(definite, "M", "is not positive [kg]; no motion may have a negative kinetic energy")
    require(count <= lumps, "modes", f"is {count} [1]; at most {lumps} unknowns have a mass")
    shift = 1e-8 * float(np.max(k.diagonal()[heavy > 0.0] / heavy[heavy > 0.0], initial=0.0)) or 1.0
    for _ in range(2):  # the second time with the first frequency as the scale
        try:
            squares, x = lowest_modes(k, m, shift, count, dense_limit=DENSE_LIMIT)
            if 2 * count > heavy.size == lumps:  # the shifted inverse leaves the highest modes no digits
                values, shapes = eigh(k.toarray(), m.toarray())
                apart = 1 + np.flatnonzero(np.diff(values[:count]) > SAME * values[1:count])
                upper = slice(int(min(apart[apart >= heavy.size // 2], default=count)), count)
                squares[upper], x[:, upper] = values[upper], shapes[:, upper]
            x = x / np.sqrt(np.einsum("ik,ik->k", x, m @ x))
        except (np.linalg.LinAlgError, ArpackError, RuntimeError) as error:
            words = f"and M give no modes ({shown(str(error))}); K must not be negative, nor both zero"
            require(False, "K", words)
        terms = np.einsum("ik,ik->k", abs(x), abs(k) @ abs(x))
        parts = np.divide(np.einsum("ik,ik->k", x, k @ x), terms, out=0.0 * terms, where=terms > 0.0)
        strained = parts > NO_STRAIN
        shift = float(squares[strained].min()) if np.any(strained) else shift
    squares = np.where(strained, squares, 0.0)
    require(bool(np.all(parts > -NO_STRAIN)), "K", f"has the negative energy {parts.min():.3g} of its terms")
    lost = strained & (parts < UNCERTAIN)
    words = f"leaves mode {1 + int(np.argmax(lost))} no digits: rounding is {NO_STRAIN:g} of its terms"
    require(not np.any(lost), "K", f"{words}, its energy {parts[np.argmax(lost)]:.3g}")
    left = np.linalg.norm(k @ x - (m @ x) * squares, axis=0)
    scale = np.linalg.norm(abs(k) @ abs(x) + (abs(m) @ abs(x)) * np.maximum(squares, shift), axis=0)
    mixed = float(np.abs(x.T @ (m @ x) - np.eye(count)).max())
    words = f"and M leave residuals of {np.max(left / scale):.3g} and shapes {mixed:.3g} from orthogonal"
    require(
        bool(np.all(left <= ROUNDING * scale)) and mixed < SAME, "K", f"{words} [1]; both must be rounding"
    )
    below = (1.0 - 1e-6) * squares[-1]
    known = int(np.sum(squares < below))
    if squares[-1] > 0.0:
        counted = _negative(csr_array(k - below * m))
        words = f"and M have {counted} modes below {np.sqrt(below):.6g} rad/s, of which {known} were found"
        require(counted == known, "K", words)
    return np.sqrt(squares), x


def _inverse(matrix: csr_array, row: Array) -> float | None:
    """Return row^T A^-1 row over the unknowns with an entry; None where A is singular for the row."""
    kept = np.flatnonzero(matrix.diagonal() > 0.0)
    if np.any(np.delete(row, kept)):
        return None
    part, right = matrix[kept][:, kept].tocsc(), row[kept]
    try:
        solved = splu(part).solve(right)
    except RuntimeError:  # exactly singular
        return None
    energy, terms = float(right @ solved), float(np.abs(solved) @ (abs(part) @ np.abs(solved)))
    return energy if energy > UNCERTAIN * terms else None


def _decay_rates(c: csr_array, omega: Array, x: Array) -> tuple[Array, Array]:
    """Return the decay rates [1/s], and the shapes.

    Among modes of equal frequency the shapes are chosen such that C does not couple them.
    """
    groups = np.split(np.arange(omega.size), 1 + np.flatnonzero(np.diff(omega) > SAME * omega[1:]))
    x = np.hstack([x[:, one] @ np.linalg.eigh(x[:, one].T @ (c @ x[:, one]))[1] for one in groups])
    full, terms = x.T @ (c @ x), np.einsum("ik,ik->k", abs(x), abs(c) @ abs(x))
    rates = np.where(np.abs(full.diagonal()) > NO_STRAIN * terms, full.diagonal(), 0.0)
    require(
        bool(np.all(rates >= 0.0)), "C", f"has the decay rate {rates.min():.3g} 1/s; none may be negative"
    )
    rounding = NO_STRAIN * np.sqrt(np.outer(terms, terms))
    apart = np.maximum(np.abs(full - np.diag(full.diagonal())) - rounding, 0.0)
    size = np.sqrt(np.outer(rates, rates))
    largest = np.max(np.divide(apart, size, out=np.where(apart > 0.0, np.inf, 0.0), where=size > 0.0))
    words = f"couples the modes: the largest |c_kl|/sqrt(c_kk c_ll) is {largest:.3g} [1], above {COUPLED:g}"
    require(bool(largest <= COUPLED), "C", words)
    return rates, x
