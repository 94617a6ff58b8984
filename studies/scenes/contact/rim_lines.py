"""Grid lines with one on the rim of contact, where a closed form knows it.

Between even lines the rim lies elsewhere on every mesh, and its error with it: a sequence of meshes then scatters by as
much as it converges. With a line on the rim only the size of the elements changes along a sequence.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from formulations.geometry.grid import graded_lines
from studies.request import Request
from studies.scene import Setting, UsageError
from studies.scenes.element import Span, spaced_lines

RIM_LINES = Setting.one_of("lines", ("even", "rim"), "even", "grid lines: evenly spaced, or one on the exact rim")
ON_RIM = {"lines": "rim"}
COARSE = 16  # elements; meshes that come from one no coarser by halving are nested


def contact_lines(request: Request, axis: int, ends: Span, rim: Callable[[], float]) -> np.ndarray:
    """The lines of a coordinate by RIM_LINES; rim(): its place by the closed form, a ValueError where it has none."""
    if request.choice("lines") == "even":
        return spaced_lines(*ends, request.mesh[axis])
    try:
        return rim_lines(request.mesh[axis], ends, rim())
    except ValueError as error:
        raise UsageError(f"lines=rim needs a rim of contact: {error}") from error


def rim_lines(n: int, ends: Span, rim: float) -> np.ndarray:
    """n + 1 lines, evenly spaced on either side of ``rim``; those of 2 n contain them where n is at least COARSE.

    Raises ValueError when the rim is not between the ends.
    """
    first, last = ends
    coarse = n
    while coarse % 2 == 0 and coarse >= 2 * COARSE:
        coarse //= 2
    before = n // coarse * min(max(round(coarse * (rim - first) / (last - first)), 1), coarse - 1)
    return graded_lines([first, rim, last], [before, n - before])
