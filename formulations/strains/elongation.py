"""Engineering strains, elongations and angles of shear: a measure that is NOT quadratic in the gradients.

It shows that the protocol asks for no table of constants. Functions of the Green-Lagrange strains alone, they vanish
under every rigid motion with them.
"""

from dataclasses import dataclass

import numpy as np

from formulations.strains.measure import EXACT_LAW, QuadraticMeasure, RigidBodyLaw
from formulations.strains.quantities import FULL, N_E, STRAINS, Kinematics

_NORMAL = [STRAINS.index(name) for name in ("E11-", "E11+", "E22-", "E22+", "E33")]
# (shear row, the two normal rows it is measured against)
_SHEARS = [(4, 0, 2), (5, 1, 3), (6, 0, 10), (7, 1, 10), (8, 2, 10), (9, 3, 10)]


@dataclass(frozen=True, eq=False)
class ElongationMeasure:
    """Elongation sqrt(1 + 2E_aa) - 1 of each direction, angle arcsin(2E_ab/(Lambda_a Lambda_b)) between two of them.

    Lambda = sqrt(1 + 2E) is the stretch, E the Green-Lagrange strain of ``base``. NaN where a line is pressed to
    nothing (1 + 2E <= 0). Source: Novozhilov, Foundations of the Nonlinear Theory of Elasticity (1953), ch. 1.
    """

    base: QuadraticMeasure
    name: str = "elongation"
    reference: str = "Novozhilov (1953), ch. 1: relative elongations and shears (recalled)"
    rigid_body_law: RigidBodyLaw = EXACT_LAW
    kinematics: Kinematics = FULL
    work: float = 5.0  # operations of a derivative over those of ``base``, which it needs several times
    meaning: str = "elongations and angles of shear of the deformed body; neglects nothing"

    @property
    def formulas(self) -> dict[str, str]:
        """By the Green-Lagrange strains G of the base and the stretches Lambda."""
        normal = {f"{a}{a}": f"sqrt(1 + 2 G{a}{a}) - 1" for a in "123"}
        shear = {f"{a}{b}": f"arcsin(2 G{a}{b}/(Λ{a} Λ{b})), Λ{a} = sqrt(1 + 2 G{a}{a})" for a, b in ("12", "13", "23")}
        return {
            **{f"E{pair}": text for pair, text in normal.items()},
            **{f"2E{pair}": text for pair, text in shear.items()},
        }

    def strain(self, q: np.ndarray) -> np.ndarray:
        """Elongations and angles, (..., 11)."""
        E = self.base.strain(q)
        strain = np.empty_like(E)
        with np.errstate(invalid="ignore", divide="ignore"):
            normal = E[..., _NORMAL]
            strain[..., _NORMAL] = 2 * normal / (1 + np.sqrt(1 + 2 * normal))  # sqrt(1 + 2E) - 1 without cancelling
            for row, a, b in _SHEARS:
                strain[..., row] = np.arcsin(E[..., row] / np.sqrt((1 + 2 * E[..., a]) * (1 + 2 * E[..., b])))
        return strain

    def gradient(self, q: np.ndarray) -> np.ndarray:
        """Chain rule, (..., 11, 15)."""
        first, _ = self._derivatives(self.base.strain(q), None)
        return np.matmul(first, self.base.gradient(q))

    def contract(self, q: np.ndarray, resultants: np.ndarray) -> np.ndarray:
        """H_n d2E_n/dq2 = (H f')_m d2E_m/dq2 + G^T (H f'') G, with G = dE/dq of the base, (..., 15, 15)."""
        first, second = self._derivatives(self.base.strain(q), resultants)
        G = self.base.gradient(q)
        carried = np.matmul(resultants[..., None, :], first)[..., 0, :]
        return self.base.contract(q, carried) + np.matmul(G.swapaxes(-1, -2), np.matmul(second, G))

    @staticmethod
    def _derivatives(E: np.ndarray, resultants: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives dstrain/dE (..., 11, 11), and H_n d2strain_n/dE2 (..., 11, 11) for resultants H."""
        first, second = np.zeros((*E.shape, N_E)), np.zeros((*E.shape, N_E))
        H = np.zeros_like(E) if resultants is None else resultants
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            for n in _NORMAL:
                stretch = np.sqrt(1 + 2 * E[..., n])
                first[..., n, n] = 1 / stretch
                second[..., n, n] -= H[..., n] / stretch**3
            for row, a, b in _SHEARS:
                A, B = 1 / (1 + 2 * E[..., a]), 1 / (1 + 2 * E[..., b])
                unit = np.sqrt(A * B)
                x = E[..., row] * unit  # sine of the angle
                g = 1 / np.sqrt(1 - x**2)
                slopes = {row: unit, a: -x * A, b: -x * B}
                bends = {(a, a): 3 * x * A**2, (b, b): 3 * x * B**2, (a, b): x * A * B}
                bends |= {(row, a): -unit * A, (row, b): -unit * B, (row, row): np.zeros_like(x)}
                for m, slope in slopes.items():
                    first[..., row, m] = g * slope
                    for k, other in slopes.items():
                        bend = bends.get((m, k), bends.get((k, m)))
                        second[..., m, k] += H[..., row] * (g * bend + x * g**3 * slope * other)
        return first, second
