"""Solids with a face that meets others, beside the shells of :mod:`studies.scenes.faces.model`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import sparse

from contact.faces.sampling import areas
from contact.problem import Linearised
from formulations.section.laminate import Laminate
from formulations.solid.ties import TiedSolid
from formulations.solid_mesh import SolidMesh
from studies.ask.layers import Layer, solid_layer
from studies.ask.scene import Request, UsageError

GROWTH = 1.3  # of elements, one beside the other


def tied(
    request: Request, mesh: SolidMesh, laminate: Laminate, fixed: np.ndarray, face: np.ndarray, **options: Any
) -> PlacedSolid:
    """That of :meth:`TiedSolid.build` where it is; raises UsageError for a mesh with elements inside out."""
    try:
        return PlacedSolid(TiedSolid.build(mesh, laminate, fixed, face, **options))
    except ValueError as error:
        raise UsageError(f"mesh {request.mesh_text}: {error}") from None


def towards_start(n: int, length: float, near: float, share: float) -> np.ndarray:
    """n + 1 lines from 0 to a length, L sinh(b s)/sinh(b) at even s, with b such that ``near`` lies at s = share.

    Those of 2 n contain them. Evenly spaced where ``near`` is no less than that share of the length.
    """
    s = np.linspace(0.0, 1.0, n + 1)
    if near >= share * length:
        return length * s
    low, high = 1e-6, 700.0
    for _ in range(80):
        b = (low + high) / 2
        low, high = (b, high) if _sinh_ratio(share, b) * length > near else (low, b)
    return length * _sinh_ratio(s, b)


def _sinh_ratio(s: np.ndarray | float, b: float) -> np.ndarray:
    """sinh(b s)/sinh(b) for b > 0, without overflow."""
    return np.asarray(np.exp(b * (np.asarray(s) - 1)) * np.expm1(-2 * b * np.asarray(s)) / np.expm1(-2 * b))


def growing(first: float, length: float) -> np.ndarray:
    """Lines from 0 to a length, no two farther apart than ``first`` and those before by the factor GROWTH allow."""
    n = math.ceil(math.log1p(length * (GROWTH - 1) / first) / math.log(GROWTH) - 1e-9)
    at = GROWTH ** np.arange(n + 1.0) - 1
    return np.asarray(at * length / at[-1]) if n else np.zeros(1)


@dataclass(frozen=True, eq=False)
class PlacedSolid:
    """A solid in space: x = turn X + shift with its own coordinates X; turn (3, 3), shift (3,) [mm].

    Its one face that may meet others has the number that it is asked for by, 0 inner or 1 outer; one that may on both
    sides has its back as 0. The points of a face are the corners of the elements there.
    """

    solid: TiedSolid
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def n_free(self) -> int:
        """Number of unknowns."""
        return self.solid.n_free

    @property
    def conservative(self) -> bool:
        """Whether it has a potential."""
        return self.solid.conservative

    def linearise(self, u: np.ndarray, memory: object = None) -> Linearised:
        """Residual and tangent."""
        return self.solid.linearise(u, memory)

    def residual(self, u: np.ndarray) -> np.ndarray:
        """The residual alone."""
        return self.solid.residual(u)

    def energy(self, u: np.ndarray) -> float:
        """The potential [N mm]."""
        return self.solid.energy(u)

    def _patches(self, face: int) -> np.ndarray:
        """Of a face (F, 4), by nodes of the mesh."""
        return self.solid.behind if face == 0 and len(self.solid.back) else self.solid.patches

    def face(self, face: int) -> tuple[np.ndarray, sparse.csr_matrix, np.ndarray]:
        """Positions (k, 3) at rest, displacements (3k, n), and patches (F, 4) turned outwards."""
        body = self.solid.solid.discretisation
        patches, corners = self._patches(face), self.points_of(face)
        turn = sparse.kron(sparse.eye_array(len(corners)), self.turn, format="csr")
        operator = turn @ body.displacement_operator(corners) @ self.solid.operator
        patches = np.searchsorted(corners, patches)
        return body.mesh.x[corners] @ self.turn.T + self.shift, sparse.csr_matrix(operator), patches

    def held(self, face: int) -> list[sparse.csr_matrix]:
        """Those of the face itself."""
        return [self.face(face)[1]]

    def areas(self, face: int) -> np.ndarray:
        """Shares (k,) [mm^2] of the points in the face."""
        return areas(self.solid.solid.discretisation.mesh.x, self._patches(face))[self.points_of(face)]

    def points_of(self, face: int) -> np.ndarray:
        """Where the points of the face (k,) are among those of :meth:`layer`."""
        return np.unique(self._patches(face))

    @property
    def nodes(self) -> np.ndarray:
        """The node that each point of :meth:`layer` is."""
        return np.arange(len(self.solid.solid.discretisation.mesh.x))

    def layer(self, u: np.ndarray, pressure: np.ndarray) -> Layer:
        """Points, cells and what they carry, with the pressure (N,) [MPa] at the corners of its face."""
        layer = solid_layer(self.solid.solid.discretisation.mesh, self.solid.expand(u), self.solid.between(pressure))
        return layer.placed(self.turn, self.shift)
