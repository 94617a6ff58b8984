"""Floating-point operations that this process has done on contact problems, by kind: a clock, read before and after.

Each kind is counted where it is done, so that nothing is left out: not what the judge does, nor what was in vain. Read
as ``time.process_time`` is, by whoever wants to know, and by nothing that is solved.
"""

from collections import Counter

FACTORISATIONS, SOLUTIONS, COLUMNS = "factorisations", "triangular_solutions", "condensed_columns"
DENSE_PIVOTS, PROGRAMMES = "dense_pivots", "quadratic_programmes"
KINDS = (FACTORISATIONS, SOLUTIONS, COLUMNS, DENSE_PIVOTS, PROGRAMMES)
SPENT: Counter[str] = Counter(dict.fromkeys(KINDS, 0))


def spend(kind: str, operations: float) -> None:
    """Count operations of one of KINDS."""
    SPENT[kind] += round(operations)


def dense_solution(n: int, sides: int = 1) -> float:
    """Of a dense system of n equations: 2 n^3/3 for L and U, 2 n^2 for each right-hand side."""
    return 2 * n**3 / 3 + 2.0 * n * n * sides


def eigenvalues_alone(n: int) -> float:
    """Of a symmetric matrix (n, n): its reduction to three diagonals."""
    return 4 * n**3 / 3
