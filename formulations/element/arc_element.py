"""The mixed element whose bending strains are those of the arc through its nodes, and not of the chords between them.

Between nodes whose directors turn by phi, faces are straight: where E33 is sampled at the nodes and the membrane gives
way, the difference of E11 on both faces is that of chords, beta = b l/h = 2 sin(phi/2), and the moment of an element of
bending stiffness D falls behind, M l/D = sin(phi). On the uniform mode the difference b of either direction becomes::

    b' = h/l (2 asin(beta/2) + phi0 beta^2/8),    phi0 = k l        on components
    b' = h/l (2 asin(beta/2) + phi0 beta^2/8 + phi0^2 beta/6)       on positions

so that M l/D = phi: exactly in flat elements, to the third order in curved ones (see the moments of
:class:`formulations.element.mixed.MixedElement` with s = 1, which this inverts). E33 sampled elsewhere would not do: it
is the same at a node of two elements, and not what each of them needs where the curvature varies along a thin shell. A
cantilever of four elements, each 25 times as long as thick, is 16 % too stiff with half of it at the Gauss points.

Measures that leave strains in a plate that turns have other curvatures, and no arcs. Twist is left as it is. Beyond
EDGE, where chords turn by 144 degrees, the law goes on linearly.

No displacement and no load may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from formulations.element.mixed import MODE_WEIGHTS, N_M, MixedElement
from formulations.element.modal import ALL, Stiffness
from formulations.element.strain_operator import ON_LINES, ElementGeometry
from formulations.strains.measure import StrainMeasure
from formulations.strains.quantities import N_E

EDGE = 0.95  # of the largest beta/2
BENDING = np.zeros((2, N_M))  # b of mode strains: E11+ - E11- and E22+ - E22- on the uniform mode
BENDING[[0, 0, 1, 1], range(4)] = -1.0, 1.0, -1.0, 1.0


def refusal(thickness_strain: str, interpolation: str, measure: StrainMeasure, *, two_faces: bool) -> str:
    """Why elements do not bend along arcs with these options; "" where they do."""
    if thickness_strain != "nodal":
        return f"arcs need thickness strain nodal, got {thickness_strain}"
    if interpolation not in ON_LINES:
        return f"arcs need lines of curvature: interpolation {' or '.join(ON_LINES)}, got {interpolation}"
    if not two_faces:
        return "arcs apply to two faces only, and the wall has surfaces between them"
    return (
        "" if measure.rigid_body_law.turns else f"arcs apply to large rotations, which measure {measure.name} neglects"
    )


@dataclass(frozen=True, eq=False)
class ArcElement(MixedElement):
    """slenderness (E, 2): l/h along both coordinates.  angle (E, 2): phi0.  positions: whether interpolated."""

    slenderness: np.ndarray
    angle: np.ndarray
    positions: bool

    @classmethod
    def on(cls, element: MixedElement, slenderness: np.ndarray, angle: np.ndarray, *, positions: bool) -> Self:
        """Of an element whose E33 is sampled at the nodes."""
        own = {field.name: getattr(element, field.name) for field in fields(MixedElement)}
        return cls(**own, slenderness=slenderness, angle=angle, positions=positions)

    @property
    def linear(self) -> bool:
        """It is not."""
        return False

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """dW/dE (e, 22) of the energy 1/2 E'.D E'."""
        bent = self._bent(strains, part)
        return bent.along(super().resultants(bent.strains, part))

    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means (E, 11) [N/mm] of D E', those of arcs: what does work with strains of chords is larger by db'/db."""
        return super().resultants(self._bent(strains, ALL).strains)[:, :N_E]

    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means (E, 11) of the strains of arcs."""
        return super().mean_strains(geometry, self._bent(strains, ALL).strains)

    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains of arcs (E, 4, 11) at the Gauss points."""
        return super().at_gauss(geometry, self._bent(strains, ALL).strains)

    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Of the strains of arcs."""
        bent = self._bent(self.mode_strains(geometry, v), ALL).strains
        return float(0.5 * geometry.weight @ np.sum(MODE_WEIGHTS * bent * super().resultants(bent), axis=-1))

    def _response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, Stiffness]:
        bent = self._bent(strains, part)
        H = super().resultants(bent.strains, part)
        moment = 0.5 * H @ BENDING.T
        return bent.along(H), ArcStiffness((self._weighted_stiffness(part),), bent, bent.bend * moment)

    def _bent(self, strains: np.ndarray, part: slice) -> Bent:
        ratio, angle = self.slenderness[part], self.angle[part]
        half = 0.5 * ratio * (strains @ BENDING.T)
        inside = np.clip(half, -EDGE, EDGE)
        rise = 1.0 / np.sqrt(1.0 - inside**2)
        slope = rise + 0.5 * angle * inside + (angle**2 / 6 if self.positions else 0.0)
        turned = 2 * np.arcsin(inside) + 0.5 * angle * inside**2
        turned += (angle**2 / 3 * inside if self.positions else 0.0) + 2 * slope * (half - inside)
        bend = ratio * np.where(half == inside, 0.5 * inside * rise**3 + 0.25 * angle, 0.0)
        return Bent(strains + 0.5 * ((turned - 2 * half) / ratio) @ BENDING, slope, bend)


@dataclass(frozen=True, eq=False)
class Bent:
    """strains (e, 22) of arcs; slope, bend (e, 2): db'/db and d2b'/db2."""

    strains: np.ndarray
    slope: np.ndarray
    bend: np.ndarray

    def along(self, rows: np.ndarray) -> np.ndarray:
        """What a change of strains (e, 22, ...) is on arcs, and resultants on chords of those on arcs: symmetric."""
        return rows + _on_bending(0.5 * (self.slope - 1), rows)


@dataclass(frozen=True, eq=False)
class ArcStiffness(Stiffness):
    """By the strains of chords.  turning (e, 2): the moment times d2b'/db2."""

    bent: Bent
    turning: np.ndarray

    def times(self, strains: np.ndarray) -> np.ndarray:
        """(e, 22, j) of (e, 22, j)."""
        bent = self.bent.along(super().times(self.bent.along(strains)))
        return bent + _on_bending(self.turning, strains)


def _on_bending(factor: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """BENDING^T factor BENDING times the rows (e, 22, ...); factor (e, 2)."""
    flat = rows.reshape(len(rows), N_M, -1)
    return np.matmul(BENDING.T, factor[..., None] * np.matmul(BENDING, flat)).reshape(rows.shape)
