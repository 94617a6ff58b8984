"""The pattern of a mesh: what is found once serves others with the same numbers, and nobody else."""

import numpy as np
import pytest

from formulations.element.sparsity import LARGE, Pattern

NUMBER = np.array([[0, 1, 2, -1], [2, 1, 3, 4]])


def dense(pattern: Pattern, matrices: np.ndarray) -> np.ndarray:
    return pattern.assemble(matrices).toarray()


def summed(number: np.ndarray, matrices: np.ndarray, n: int) -> np.ndarray:
    """Entry by entry."""
    found = np.zeros((n, n))
    for own, matrix in zip(number, matrices, strict=True):
        for i, row in enumerate(own):
            for j, column in enumerate(own):
                if row >= 0 and column >= 0:
                    found[row, column] += matrix[i, j]
    return found


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
