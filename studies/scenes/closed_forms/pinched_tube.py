"""A thin tube between diaphragms under radial point forces half way: a double Fourier series, no element enters.

Kirchhoff's shell, linear, with the strains of Koiter and Sanders. Between ends that hold the wall in their plane and
let it move along the axis (v = w = N = M = 0) every pair of waves stands for itself::

    u = U cos(al x) cos(n th),  v = V sin(al x) sin(n th),  w = W sin(al x) cos(n th),  al = m pi/L,  m odd

    eps_x = u',  eps_th = (v. + w)/R,  gam = v' + u./R,
    kap_x = -w'',  kap_th = (v. - w..)/R^2,  kap_xth = (3 v'/2 - 2 w'.)/R - u./(2 R^2)

with ' along the axis and . around. Sources: Flügge, Stresses in Shells (1960), for the series; Budiansky, Sanders, On
the best first-order linear shell theory (1963), for the strains.
"""

import numpy as np

WAVES = 200  # along and around: what is left is 1e-6 of the deflection where R/h is 100


def pinched_tube(radius: float, h: float, length: float, nu: float, forces: int, waves: int = WAVES) -> float:
    """E h w/F of the wall under a force F, inwards, 1 or 2 of which act on opposite sides of the section half way.

    Its terms fall with the fourth power of the waves, so that what these leave out falls with the square: half of them
    say how much it is. Raises ValueError for another number of forces.
    """
    if forces not in (1, 2):
        raise ValueError(f"forces = {forces}: 1 or 2 act on a section")
    al = np.pi / length * np.arange(1, waves, 2)[:, None]
    n = np.arange(0, waves, forces)[None, :] * 1.0  # odd waves of two forces cancel
    zero, one = np.zeros((al.size, n.size)), np.ones((al.size, n.size))
    R, D = radius, h**2 / 12
    # strains (2, 3): normal ones, of the waves sin cos, by U, V, W, and shear, of the waves cos sin
    membrane = [[-al * one, zero, zero], [zero, n / R * one, one / R], [-n / R * one, al * one, zero]]
    bending = [
        [zero, zero, al**2 * one],
        [zero, n / R**2 * one, n**2 / R**2 * one],
        [n / (2 * R**2) * one, 1.5 * al / R * one, 2 * al * n / R * one],
    ]
    law = np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]]) / (1 - nu**2)
    stiffness = sum(
        factor * np.einsum("aimn,ab,bjmn->mnij", np.array(strains), law, np.array(strains))
        for factor, strains in ((1.0, membrane), (D, bending))
    )
    mean = np.where(n == 0, 2.0, 1.0) * np.pi * R * length / 2  # of the squares of the waves over the area
    load = np.zeros((*zero.shape, 3, 1))
    load[..., 2, 0] = forces
    terms = np.linalg.solve(stiffness * mean[..., None, None], load)[..., 2, 0]
    half = terms[(al[:, 0] < np.pi / length * waves / 2)][:, n[0] < waves / 2]
    return float((4 * terms.sum() - half.sum()) / 3)
