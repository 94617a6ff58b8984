"""Short waves on a deformed shell: whether its equations are strongly elliptic, element by element.

Waves v = a exp(i k n.s) of the six face displacements on a deformed shell, short beside everything that varies, change
the gradients by q = i k T(n) a, and the strain energy per area by k^2/2 a.A(n) a with the acoustic tensor::

    A(n) = T^T (B^T D B + H_m d2E_m/dq2) T,    B = dE/dq,    T(n) = n1 A1 C1 + n2 A2 C2

C_a the coefficients of v,a in q. Where A(n) is positive for every direction n (the condition of Legendre and Hadamard),
short waves cost energy. Where it is not, all that are short enough release some: the boundary value problem has no
length of its own, and what a grid makes of it (where it buckles, and at what load) is decided by its elements.
Source: Ogden, Non-linear Elastic Deformations (1984), section 6.2; Rice, Proc. 14th IUTAM Congr. (1976) 207-220.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from formulations.shell import ShellModel
from formulations.strains.quantities import N_E, N_Q, gradient_coefficients, shear_row_factors

DIRECTIONS = 36  # of n, over half a turn


@dataclass(frozen=True, eq=False)
class ShortWaves:
    """Of each element: the least eigenvalue of A [N/mm], the angle of its n from a1 [rad], and its a (E, 6)."""

    least: np.ndarray
    angle: np.ndarray
    amplitude: np.ndarray


def short_waves(shell: ShellModel, u: np.ndarray) -> ShortWaves:
    """At the middles of the elements, from their mean gradients and strains; u (n,) free displacements.

    D counts by its symmetric part, which is all that an energy sees. Raises ValueError with surfaces inside the wall.
    """
    if shell.discretisation.wall is not None:
        raise ValueError("short waves are those of a wall between two faces")
    angles = np.arange(DIRECTIONS) * np.pi / DIRECTIONS
    eigen = [np.linalg.eigh(A) for A in acoustic_tensors(shell, u, angles)]
    values, vectors = (np.array([each[i][..., 0] for each in eigen]) for i in (0, 1))
    best = np.argmin(values, axis=0)
    every = np.arange(len(best))
    return ShortWaves(values[best, every], angles[best], vectors[best, every])


def acoustic_tensors(shell: ShellModel, u: np.ndarray, angles: np.ndarray) -> Iterator[np.ndarray]:
    """A(n) (E, 6, 6) [N/mm] at the middles of the elements for each direction n at an angle [rad] from a1."""
    hessian, (C1, C2) = _hessian(shell, u), _slopes(shell)
    for angle in angles:
        T = np.cos(angle) * C1 + np.sin(angle) * C2
        yield T.swapaxes(-1, -2) @ hessian @ T


def _hessian(shell: ShellModel, u: np.ndarray) -> np.ndarray:
    """Second derivative (E, 15, 15) of the strain energy per area by q, at the mean q of each element [N/mm]."""
    geometry, dofs = shell.discretisation.geometry, shell.discretisation.dofs
    v = shell.displacements(u).reshape(-1)[dofs]
    at_gauss = np.matmul(geometry.Q, v[..., None]).reshape(len(v), -1, N_Q)
    q = (at_gauss if geometry.offset is None else geometry.offset + at_gauss).mean(axis=1)
    D, rows = shell.discretisation.laminate.stiffness(shell.section), _rows(shell)
    resultants = shell.resultants(u)[:, :N_E] + (0.0 if shell.initial is None else shell.initial)
    B = shell.measure.gradient(q) * rows[..., None]
    return B.swapaxes(-1, -2) @ (0.5 * (D + D.T)) @ B + shell.measure.contract(q, resultants * rows)


def _rows(shell: ShellModel) -> np.ndarray:
    """Factors (E, 11) of the strain rows at the middles."""
    own, laminate = shell.discretisation, shell.discretisation.laminate
    at = own.surface.geometry(own.grid.centre[:, 0], own.grid.centre[:, 1])
    return shear_row_factors(at, laminate.d_minus, laminate.d_plus, shell.measure.kinematics)


def _slopes(shell: ShellModel) -> tuple[np.ndarray, np.ndarray]:
    """A1 C1 and A2 C2, (E, 15, 6) each: q from the derivatives by length along a1 and a2."""
    own, laminate = shell.discretisation, shell.discretisation.laminate
    at = own.surface.geometry(own.grid.centre[:, 0], own.grid.centre[:, 1])
    _, C1, C2 = gradient_coefficients(at, laminate.d_minus, laminate.d_plus, shell.measure.kinematics)
    return at.A[:, 0, None, None] * C1, at.A[:, 1, None, None] * C2
