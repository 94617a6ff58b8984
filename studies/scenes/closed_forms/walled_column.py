"""A column between clamps that is shortened and bows against a rigid wall: Euler and Bernoulli's beam, small slopes.

Units: length L = 1, clearance of the wall 1, Euler's load P_E = 4 pi^2 EI/L^2 = 1: k = sqrt(P/EI) = 2 pi sqrt P. The
shortening by bending, int w'^2/2, is in units of clearance^2/L, forces of the wall in those of P_E clearance/L. On
one half the column is w = a (1 - cos k x) + b (x - sin(k x)/k), with w' = 0 and w = 1 where it meets the wall: in the
middle up to P = 4 P_E, then at x = 1/sqrt P, where it has no curvature and its flat part begins, without pressure on
it. That one is a column between clamps, too, and buckles at 9 P_E. Source: Domokos, Holmes, Royce, J. Nonlinear Sci. 7
(1997) 281 (recalled; derived anew). No shell enters here.
"""

import math

POINT, LINE = 4.0, 9.0  # the largest loads in point and in line contact


def bent(load: float) -> tuple[float, float]:
    """Shortening by bending, and force of the wall; with a straight flat part beyond LINE, too.

    Raises ValueError below 1.
    """
    if load < 1:
        raise ValueError(f"P = {load:g} P_E must be at least 1: the column touches the wall at P_E")
    if load > POINT:
        return 1.5 * math.sqrt(load), 2 * load**1.5
    k = 2 * math.pi * math.sqrt(load)
    t = k / 2
    scale = math.cos(t / 2) / 2 - 2 / k * math.sin(t / 2)
    ak, b = -math.sin(t / 2) / scale, math.cos(t / 2) / scale
    squares = ak**2 * (1 / 4 - math.sin(2 * t) / (4 * k)) + b**2 * (
        3 / 4 - 2 * math.sin(t) / k + math.sin(2 * t) / (4 * k)
    )
    return squares + 2 * ak * b / k * (1 - math.cos(t) - math.sin(t) ** 2 / 2), 2 * load * b


def load_at(shortening: float, extension: float) -> float:
    """P/P_E at a shortening of which ``extension`` P/P_E is not by bending: 1 until the column touches.

    Raises ValueError beyond 9 P_E.
    """
    low, high = 1.0, LINE
    if bent(low)[0] + extension >= shortening:
        return min(shortening / extension, 1.0)
    if bent(high)[0] + extension * high < shortening:
        raise ValueError(f"a shortening of {shortening:g} is beyond that at {LINE:g} P_E")
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if bent(middle)[0] + extension * middle < shortening else (low, middle)
    return middle
