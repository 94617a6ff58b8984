"""The recurrence of power series against the polynomial that the internal force is, fitted through its values.

The pattern of a mesh: what is found once serves others with the same numbers, and nobody else.
"""

import numpy as np
import pytest

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.series import Products
from formulations.element.sparsity import LARGE, Pattern
from formulations.element.strain_operator import ON_LINES
from formulations.loads import Pressure
from formulations.shell import ShellModel
from formulations.shell_series import ShellSeries
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from support.problems.shells import PATCHES, make_shell

PATCH = PATCHES["wavy"]
ORDER = 4
FITTED = (
    1e-9  # relative, of coefficients of a polynomial of degree 12 from its values at roots of unity: 1e-12 measured
)
ROUNDING = 1e-13
QUADRATIC = {name: measure for name, measure in MEASURES.items() if isinstance(measure, QuadraticMeasure)}
ELEMENTS = [
    *({"measure": name} for name in QUADRATIC if QUADRATIC[name].kinematics == MEASURES["exact"].kinematics),
    *(
        {"thickness_strain": t, "membrane": m, "interpolation": i}
        for t in THICKNESS_STRAINS
        for m in MEMBRANES
        for i in ON_LINES
    ),
]


def force_coefficients(shell: ShellModel, u: np.ndarray) -> np.ndarray:
    """Coefficients (4 N, n) of r(sum u_k a^k), of degree 3 N, from its values at points of [-1, 1]."""
    degree = 3 * (len(u) - 1)
    a = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    values = [shell.residual(np.polynomial.polynomial.polyval(each, u)) for each in a]
    return np.linalg.solve(np.vander(a, increasing=True), np.array(values))


@pytest.mark.parametrize("options", ELEMENTS, ids=lambda options: "-".join(options.values()))
def test_what_lower_orders_leave_is_the_rest_of_the_force(options, rng) -> None:
    shell = make_shell(PATCH.surface, PATCH.grid(2, 3), **options)
    n = shell.discretisation.n_free
    u = rng.normal(size=(ORDER + 1, n)) * 0.05
    expected = force_coefficients(shell, u)
    tangent, series = shell.linearise(u[0]).tangent.copy(), ShellSeries.of(shell, u[0], ORDER)
    left = [np.zeros(n)] + [series.add(each).copy() for each in u[1:]]
    for k in range(1, ORDER + 1):
        rest = expected[k] - tangent @ u[k]
        np.testing.assert_allclose(left[k - 1], rest, rtol=0, atol=FITTED * np.abs(expected).max())
        if k > 1 and options.get("measure") != "linear":
            assert np.abs(rest).max() > 1e6 * FITTED * np.abs(expected).max()


@pytest.mark.parametrize("measure", QUADRATIC.values(), ids=QUADRATIC)
def test_products_by_monomials_are_those_of_the_tables(measure, rng) -> None:
    q, H = rng.normal(size=(8, 15, 3)), rng.normal(size=(8, 11, 3))
    products = Products(measure, 7, 3)
    products.q[:], products.H[:] = q, H
    for k in range(1, 8):
        pairs = [(i, k - i) for i in range(1, k)]
        strain = sum((0.5 * np.einsum("nij,ip,jp->np", measure.quadratic, q[a], q[b]) for a, b in pairs), 0.0 * H[0])
        force = sum((np.einsum("nij,jp,np->ip", measure.quadratic, q[a], H[b]) for a, b in pairs), 0.0 * q[0])
        np.testing.assert_allclose(products.strain(k), strain, rtol=0, atol=1e2 * ROUNDING)
        np.testing.assert_allclose(products.force(k), force, rtol=0, atol=1e2 * ROUNDING)


def test_what_is_no_polynomial_has_no_series() -> None:
    for options, reason in (
        ({"measure": "elongation"}, "not quadratic"),
        ({"pressure": Pressure(0.7, follower=True)}, "follows"),
    ):
        shell = make_shell(PATCH.surface, PATCH.grid(1, 1), **options)
        with pytest.raises(ValueError, match=reason):
            ShellSeries.of(shell, np.zeros(shell.discretisation.n_free), ORDER)


NUMBER = np.array([[0, 1, 2, -1], [2, 1, 3, 4]])


def dense(pattern: Pattern, matrices: np.ndarray) -> np.ndarray:
    return pattern.assemble(matrices).toarray()


def summed(number: np.ndarray, matrices: np.ndarray, n: int) -> np.ndarray:
    """Entry by entry."""
    actual = np.zeros((n, n))
    for own, matrix in zip(number, matrices, strict=True):
        for i, row in enumerate(own):
            for j, column in enumerate(own):
                if row >= 0 and column >= 0:
                    actual[row, column] += matrix[i, j]
    return actual


@pytest.mark.parametrize(
    "number", [NUMBER, NUMBER.astype(np.int32), np.where(NUMBER == 0, -1, NUMBER), NUMBER[:, ::-1]]
)
def test_numbers_that_differ_have_patterns_of_their_own(number: np.ndarray, rng) -> None:
    Pattern.build(NUMBER, 5)
    matrices = rng.normal(size=(2, 4, 4))
    np.testing.assert_allclose(dense(Pattern.build(number, 5), matrices), summed(number, matrices, 5))


def test_equal_numbers_have_one_pattern_with_what_constrains_each(rng) -> None:
    """Of two unknowns with other factors, and beyond a size for everyone anew."""
    matrices = rng.normal(size=(2, 4, 4))
    patterns = []
    for factor in (1.0, -2.0):
        C = np.eye(4)[None] * factor
        patterns.append(Pattern.build(NUMBER.copy(), 5, (np.array([1]), NUMBER[1:], C)))
        own = matrices * np.array([1.0, factor**2])[:, None, None]
        np.testing.assert_allclose(dense(patterns[-1], matrices), summed(NUMBER, own, 5))
    assert patterns[0].slots is patterns[1].slots
    many = np.tile(NUMBER, (LARGE // NUMBER.size + 1, 1))
    assert Pattern.build(many, 5).slots is not Pattern.build(many, 5).slots


@pytest.mark.parametrize("seed", range(8))
def test_blocks_of_unknowns_that_elements_share_are_summed_entry_by_entry(seed: int) -> None:
    """Nodes of up to three unknowns, some of them held, met in any order, and an element that is constrained."""
    rng = np.random.default_rng(seed)
    free = np.where(rng.random((6, 3)) < 0.7, 1, 0)
    of_node = np.where(free, np.cumsum(free).reshape(6, 3) - 1, -1)
    number = np.stack([of_node[rng.permutation(6)[:4]].ravel() for _ in range(5)])
    n, theirs = int(free.sum()), number[4:, rng.permutation(12)[:7]]
    matrices, C = rng.normal(size=(5, 12, 12)), rng.normal(size=(1, 12, 7))
    pattern = Pattern.build(number, n, (np.array([4]), theirs, C))
    wanted = summed(number[:4], matrices[:4], n) + summed(theirs, C.swapaxes(1, 2) @ matrices[4:] @ C, n)
    np.testing.assert_allclose(dense(pattern, matrices), wanted, atol=1e-12)
    assert pattern.assemble(matrices).has_canonical_format


def test_a_mesh_that_is_held_everywhere_has_an_empty_pattern() -> None:
    held, matrices = np.full((2, 4), -1), np.ones((2, 4, 4))
    for constrained in (None, (np.array([1]), held[1:], np.ones((1, 4, 4)))):
        pattern = Pattern.build(held, 0, constrained)
        assert (pattern.indptr.tolist(), pattern.slots.tolist()) == ([0], [0] * 32)
        assert dense(pattern, matrices).shape == (0, 0)
