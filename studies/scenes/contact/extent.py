"""How far a contact patch reaches along a line. No scene enters here."""

import numpy as np


def half_extent(coordinate: np.ndarray, share: np.ndarray, pressure: np.ndarray | None = None) -> float:
    """Half extent of the patch along a line through its centre, by deformed coordinates (n,) [mm].

    share (n,): 1 at nodes in contact, 0 at others, linear between them. The rim is where it is 1/2: half-way between
    the last node in contact and the first one out of it, on both sides, and so jumps by elements. With the pressures
    (n,) of the nodes it is taken within the element: the last node collects pressure from its share of the line as far
    as that touches, and should have what the two nodes before it extrapolate to.
    """
    share = np.asarray(share, float)
    touching = np.flatnonzero(share >= 0.5)
    if len(touching) == 0:
        return 0.0
    first, last = int(touching[0]), int(touching[-1])
    if pressure is None or last - first < 2:
        low, high = _at_half(coordinate, share, first, -1), _at_half(coordinate, share, last, 1)
    else:
        low = _by_pressure(coordinate[::-1], pressure[::-1], len(coordinate) - 1 - first)
        high = _by_pressure(coordinate, pressure, last)
    return float(0.5 * abs(high - low))


def _at_half(x: np.ndarray, share: np.ndarray, last: int, step: int) -> float:
    """Where the share falls to 1/2 between the last place above it and the next."""
    following = last + step
    if not 0 <= following < len(share):
        return float(x[last])
    above, below = share[last], share[following]
    return float(((above - 0.5) * x[following] + (0.5 - below) * x[last]) / (above - below))


def _by_pressure(x: np.ndarray, pressure: np.ndarray, last: int) -> float:
    """Where contact ends behind its ``last`` node: p_last/(2 p_1 - p_2), at most 1, of what that node stands for."""
    inner, outer = 0.5 * (x[last - 1] + x[last]), 0.5 * (x[last] + x[min(last + 1, len(x) - 1)])
    whole = max(2 * pressure[last - 1] - pressure[last - 2], pressure[last])
    share = pressure[last] / whole if whole > 0 else 0.0
    return float(outer - (1 - share) * (outer - inner))
