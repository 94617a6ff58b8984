"""Linear complementarity problems in the text format of Siconos (numerics, LCP): read, never written.

n, the kind of storage (0: dense), twice the shape, the rows of M, q, and whatever is said after it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from contact.interchange.untrusted import MOST, read_bytes
from studies.request import UsageError


def read_lcp(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """M (n, n) and q (n,) of z >= 0, M z + q >= 0, z.(M z + q) = 0; raises UsageError, and OSError for no file."""
    try:
        text = read_bytes(path).decode("utf-8", "replace")
        words = text.split(maxsplit=MOST)
        n, storage = int(words[0]), int(words[1])
        shapes = [int(word) for word in words[2:6]]
        if n < 1 or storage != 0:
            raise ValueError(f"n = {n}, storage {storage}: only dense matrices (0) are read")
        if shapes != [n] * 4:
            raise ValueError(f"shapes {shapes}, not {n} x {n}")
        if n * n + n > MOST:
            raise ValueError(f"{n * n + n} numbers, more than {MOST}")
        numbers = np.array([float(word) for word in words[6 : 6 + n * n + n]])
        if len(numbers) < n * n + n or not np.all(np.isfinite(numbers)):
            raise ValueError(f"{len(numbers)} of {n * n + n} finite numbers")
    except (ValueError, IndexError) as error:
        said = str(error)[:200]
        raise UsageError(f"{path} is no linear complementarity problem of Siconos: {said}") from None
    return numbers[: n * n].reshape(n, n), numbers[n * n :]
