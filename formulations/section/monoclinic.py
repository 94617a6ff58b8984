"""The general ply: any elastic stiffness with the plane of the layer as its plane of symmetry, 13 constants.

:class:`formulations.section.laminate.Laminate` asks of a ply only its thickness and its stiffness. No section enters
here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from formulations.section.laminate import NORMAL, PLANE, SHEAR, check_positive, orthotropic_stiffness

_NAMES = ("11", "22", "12", "33", "13", "23")
_IN_PLANE_AND_NORMAL = (*range(PLANE.start, PLANE.stop), NORMAL)
_TRANSVERSE = tuple(range(SHEAR.start, SHEAR.stop))
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class MonoclinicPly:
    """Layer with the stiffness B (6, 6) [MPa] in the shell axes, order 11, 22, 12, 33, 13, 23, engineering shears.

    Thickness in mm. Raises ValueError naming the entry that breaks the symmetry or couples the transverse shears with
    the rest, or the first leading minor that is not positive (Sylvester), of B scaled to a unit diagonal.
    """

    B: np.ndarray
    thickness: float

    def __post_init__(self) -> None:
        B = np.array(self.B, float)
        if B.shape != (6, 6) or not np.all(np.isfinite(B)):
            raise ValueError(f"ply stiffness must be 6 x 6 finite numbers, got the shape {B.shape}")
        check_positive(thickness=self.thickness)
        for i, name in enumerate(_NAMES):
            if not B[i, i] > 0:
                raise ValueError(f"ply is not positive definite: B_{name},{name} = {B[i, i]:g} must be > 0")
        scale = np.sqrt(np.diag(B))
        unit = B / np.outer(scale, scale)
        _refuse(unit - unit.T, "is not symmetric: B_{0},{1} - B_{1},{0}", B)
        coupling = np.zeros((6, 6))
        block = np.ix_(_IN_PLANE_AND_NORMAL, _TRANSVERSE)
        coupling[block] = unit[block]
        _refuse(coupling, "is not monoclinic: B_{0},{1}", B)
        for rows in (_IN_PLANE_AND_NORMAL, _TRANSVERSE):
            for k in range(2, len(rows) + 1):
                minor = float(np.linalg.det(unit[np.ix_(rows[:k], rows[:k])]))
                if not minor > 0:
                    names = ", ".join(_NAMES[i] for i in rows[:k])
                    raise ValueError(f"ply is not positive definite: scaled minor of {names} = {minor:.4g} must be > 0")
        B.setflags(write=False)
        object.__setattr__(self, "B", B)

    @classmethod
    def orthotropic(
        cls,
        E: Sequence[float],
        G: Sequence[float],
        nu: Sequence[float],
        angle: float,
        thickness: float,
    ) -> MonoclinicPly:
        """Nine constants in ply axes 1, 2 in the plane and 3 across it, axis 1 at ``angle`` [rad] from a1 towards a2.

        E = (E1, E2, E3), G = (G12, G13, G23) [MPa]; nu = (nu12, nu13, nu23), nu_ij the contraction along j under
        tension along i, nu_ji = nu_ij E_j/E_i. Raises ValueError naming the violated inequality: E_i, G_ij > 0,
        1 - nu_ij nu_ji > 0, 1 - nu12 nu21 - nu23 nu32 - nu31 nu13 - 2 nu21 nu32 nu13 > 0.
        Source: Jones, Mechanics of Composite Materials (1975), sect. 2.4 (recalled).
        """
        check_positive(**dict(zip(("E1", "E2", "E3", "G12", "G13", "G23"), (*E, *G), strict=True)))
        product = {(i, j): n**2 * E[j] / E[i] for (i, j), n in zip(((0, 1), (0, 2), (1, 2)), nu, strict=True)}
        for (i, j), value in product.items():
            if not value < 1:
                name = f"nu_{i + 1}{j + 1} nu_{j + 1}{i + 1}"
                raise ValueError(f"ply is not positive definite: 1 - {name} = {1 - value:.4g} must be > 0")
        determinant = 1 - sum(product.values()) - 2 * nu[0] * nu[1] * nu[2] * E[2] / E[0]
        if not determinant > 0:
            raise ValueError(
                "ply is not positive definite: 1 - nu_12 nu_21 - nu_23 nu_32 - nu_31 nu_13 - 2 nu_21 nu_32 nu_13 "
                f"= {determinant:.4g} must be > 0"
            )
        return cls(orthotropic_stiffness(E, G, nu, angle), thickness)

    def stiffness(self) -> np.ndarray:
        """B (6, 6) [MPa] in the shell axes."""
        return self.B


def _refuse(excess: np.ndarray, message: str, B: np.ndarray) -> None:
    """Raise for the largest entry of ``excess`` (6, 6) that rounding does not explain."""
    i, j = np.unravel_index(np.argmax(np.abs(excess)), excess.shape)
    if abs(excess[i, j]) > _ROUNDING:
        text = message.format(_NAMES[i], _NAMES[j])
        size = excess[i, j] * np.sqrt(B[i, i] * B[j, j])
        raise ValueError(f"ply {text} = {size:.4g} must be 0")
