"""Loads of a deck on the shell: forces, moments, pressures and the displacements of supports. No card enters here."""

from dataclasses import dataclass

import numpy as np

from formulations.element.strain_operator import ElementGeometry
from formulations.loads.pressure import Pressure
from studies.ask.request import UsageError
from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.supports import moved_of
from studies.scenes.mesh_file.surface import Mesh
from studies.scenes.statics import Loads

ABOUT_NORMAL = 1e-6  # of a moment: a smaller part of it is rounding


@dataclass(frozen=True, eq=False, kw_only=True)
class PressureOnElements(Pressure):
    """Pressure [MPa] that differs from element to element: value times ``shares`` (E,)."""

    shares: np.ndarray

    def weights(self, geometry: ElementGeometry) -> np.ndarray:
        """Area times share that each Gauss point carries, (E, 4)."""
        return super().weights(geometry) * self.shares[:, None]


def loads_of(deck: Deck, mesh: Mesh, height: np.ndarray, measure: str, *, follower: bool) -> Loads:
    """All of them; height (N,): of the wall at the nodes. Half of each force is on either face.

    A moment M is a couple of dead forces +-(M x n)/h on the faces. Raises UsageError for one about the normal n, and
    for a measure that is not linear: as the director turns, the couple loses its lever.
    """
    loads = Loads()
    if deck.forces:
        couple = mesh.along_axes(_couples(deck, mesh, measure) / height[:, None])
        half = 0.5 * mesh.along_axes(forces_of(deck, mesh))
        loads["forces"] = np.stack([half - couple, half + couple], axis=-1).reshape(len(half), 6)
    if deck.pressures:
        shares = np.array([deck.pressures.get(number, 0.0) for number in mesh.labels.tolist()])
        loads["pressure"] = PressureOnElements(1.0, follower, shares=shares)
    moved = moved_of(deck, mesh)
    if moved.any():
        loads["prescribed"] = np.repeat(moved, 2, axis=1)
    return loads


def forces_of(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) Cartesian [N]."""
    return _along(deck, mesh, 1)


def moments_of(deck: Deck, mesh: Mesh) -> np.ndarray:
    """(N, 3) Cartesian [N mm]."""
    return _along(deck, mesh, 4)


def _couples(deck: Deck, mesh: Mesh, measure: str) -> np.ndarray:
    """M x n (N, 3) of the moments."""
    moments = moments_of(deck, mesh)
    if moments.any() and measure != "linear":
        why = "as the director turns, forces on both faces lose their lever"
        raise UsageError(f"{mesh.file}: moments are understood with the measure linear alone: {why}")
    about = np.abs(np.sum(moments * mesh.normals, axis=1)) > ABOUT_NORMAL * np.linalg.norm(moments, axis=1)
    if about.any():
        normal = ", ".join(f"{x + 0.0:.3g}" for x in mesh.normals[about][0])
        node = f"the moment on node {mesh.numbers[about][0]} turns about the normal ({normal})"
        raise UsageError(f"{mesh.file}: {node}, about which the shell has no stiffness")
    return np.cross(moments, mesh.normals)


def _along(deck: Deck, mesh: Mesh, first: int) -> np.ndarray:
    """(N, 3) Cartesian: the loads of three degrees from the first on."""
    loads = np.zeros_like(mesh.middle)
    for node, components in deck.forces.items():
        for degree, value in components.items():
            if first <= degree < first + 3:
                loads[mesh.at([node])] += value * mesh.axes[mesh.at([node]), degree - first]
    return loads
