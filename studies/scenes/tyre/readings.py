"""What is read off the patch of a pressed tyre: its extents, and how far its pressure is from its images.

The images are those under the half turn about the contact normal, and under mirrors.

A map p (psi, phi) has its lines symmetric about psi = 0. Along phi it is periodic, with its first line at -pi, or,
where it covers a part of the tyre, symmetric about phi = 0. Out of contact the pressure is zero.
"""

from __future__ import annotations

import numpy as np


def image(p: np.ndarray, *, psi: bool, phi: bool, periodic: bool = True) -> np.ndarray:
    """The map at -psi, at -phi, or at both."""
    n = p.shape[1]
    turned = (-np.arange(n)) % n if periodic else np.arange(n)[::-1]
    return p[:: -1 if psi else 1][:, turned if phi else slice(None)]


def deviation(
    p: np.ndarray, touching: np.ndarray | None = None, *, psi: bool, phi: bool, periodic: bool = True
) -> float:
    """Largest difference from an image, in the unit of p; with ``touching`` only over pairs that both touch."""
    off = np.abs(p - image(p, psi=psi, phi=phi, periodic=periodic))
    if touching is None:
        return float(np.max(off))
    pairs = touching & image(touching, psi=psi, phi=phi, periodic=periodic)
    return float(np.max(off, where=pairs, initial=0.0))


def central_asymmetry(p: np.ndarray) -> float:
    """Largest |p(psi, phi) - p(-psi, -phi)| of a whole tyre."""
    return deviation(p, psi=True, phi=True)


def mirror_asymmetry(p: np.ndarray, touching: np.ndarray | None = None) -> float:
    """The larger of max |p(psi, phi) - p(-psi, phi)| and max |p(psi, phi) - p(psi, -phi)| of a whole tyre."""
    return max(deviation(p, touching, psi=psi, phi=not psi) for psi in (True, False))


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


def to_edges(x: np.ndarray, active: np.ndarray) -> float:
    """Least length along a meridian from a node in contact to an edge [mm], by deformed coordinates x (psi, phi, 3).

    Near zero the clamp carries the foundation; with no node in contact it is the longest meridian.
    """
    length = np.linalg.norm(np.diff(x, axis=0), axis=-1).cumsum(axis=0)
    low = np.concatenate([np.zeros_like(length[:1]), length])
    return float(np.min(np.minimum(low, low[-1] - low)[active], initial=np.max(low[-1])))


def asymmetries(pressure: np.ndarray) -> dict[str, float]:
    """Central and mirror asymmetry of a pressure map (psi, phi), as fractions of its peak."""
    peak = float(pressure.max())
    found = {"central_asymmetry": central_asymmetry(pressure), "mirror_asymmetry": mirror_asymmetry(pressure)}
    return {name: value / peak if peak > 0 else 0.0 for name, value in found.items()}
