"""What is read off the patch of a pressed tyre: its way to the edges, and how far its pressure is from its images.

The images are those under the half turn about the contact normal, and under mirrors.

A map p (psi, phi) has its lines symmetric about psi = 0. Along phi it is periodic, with its first line at -pi, or,
where it covers a part of the tyre, symmetric about phi = 0. Out of contact the pressure is zero.
"""

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
    measures = {"central_asymmetry": central_asymmetry(pressure), "mirror_asymmetry": mirror_asymmetry(pressure)}
    return {name: value / peak if peak > 0 else 0.0 for name, value in measures.items()}
