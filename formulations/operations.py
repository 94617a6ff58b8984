"""Floating-point operations of the elements in this process, a clock: read before and after, by nothing that is solved.

A product of matrices (m, k) and (k, n) takes 2 m k n, each number added to a sparse matrix 1. Loads that follow,
frames and the sizes of residuals are left out: they are a few in a hundred.
"""

from collections import Counter

ASSEMBLY = "assembly"
SPENT: Counter[str] = Counter({ASSEMBLY: 0})


def spend(operations: float) -> None:
    """Count operations."""
    SPENT[ASSEMBLY] += round(operations)


def product(*sizes: int) -> int:
    """Of a product of matrices, or of a batch of them."""
    operations = 2
    for size in sizes:
        operations *= size
    return operations
