"""The tyre of :mod:`studies.scenes.tyre.scene` as a 3D solid of quadratic hexahedra: the reference of all its shells.

Settings, stages, plane and readings are the same; there is no strain measure, section or middle surface. Where two
mirror planes halve the tyre (isotropic plies, cords at 0 or 90 degrees), a quarter is solved and the whole is reported.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import Candidates
from formulations.geometry.surfaces import torus
from formulations.section.laminate import LAWS
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.ask.request import Request, Value
from studies.ask.scene import Reference, Setting, Sheet, UsageError
from studies.scenes.element import ELEMENT
from studies.scenes.foundations import foundation
from studies.scenes.solids import OfSolids, SolidSceneModel
from studies.scenes.tyre.grid_lines import tyre_lines
from studies.scenes.tyre.model import ORTHOTROPIC, checked_wall, inflation
from studies.scenes.tyre.parts import mirrored, part_of
from studies.scenes.tyre.press import PATH_SETTINGS, PressedTyre, Wall
from studies.scenes.tyre.scene import Tyre

DEFAULTS: dict[str, Value] = {"load": "follower", "pressure_area": "face", "plies": 1, "ply_thickness_mm": 4.8}
ISOTROPIC: dict[str, Value] = {"E_MPa": 20.0, "nu": 0.45}
NOT_OF_A_SOLID = {
    *("section", "grading", "sector_deg", "rim"),
    *(setting.key for setting in (*PATH_SETTINGS, *ELEMENT)),
}


def _settings() -> tuple[Setting, ...]:
    kept = [setting for setting in Tyre.settings if setting.key not in NOT_OF_A_SOLID]
    settings = [replace(setting, default=DEFAULTS.get(setting.key, setting.default)) for setting in kept]
    face = {"pressure_area": replace(next(s for s in settings if s.key == "pressure_area"), choices=("face",))}
    through = Setting("per_ply", 1, "elements through each ply", "int", 1, 16)
    law = Setting.one_of("law", LAWS.keys(), "svk", "material law; of the rubber between cords, where there are any")
    return (*(face.get(setting.key, setting) for setting in settings), through, law)


@dataclass(frozen=True)
class SolidTyre(OfSolids):
    """Inflation, then contact of a solid with a plane."""

    name: str = "tyre-solid"
    title: str = "The tyre as a 3D solid of quadratic hexahedra; by default isotropic"
    default_mesh: tuple[int, int] = (28, 36)
    coarsest_mesh: tuple[int, int] = (14, 18)  # even numbers only
    settings: tuple[Setting, ...] = _settings()
    references: tuple[Reference, ...] = tuple(each for each in Tyre.references if each.kind == "computed")
    quantities = Tyre.quantities
    models: tuple[str, ...] = ("auto", "full", "quarter")
    sheet = Sheet("-x", -40.0, 14.0, mesh="14x18", settings={"delta_mm": "20"})

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """Isotropic unless plies are given; raises UsageError on a mixture."""
        given = settings.keys() & {*ORTHOTROPIC, *ISOTROPIC}
        return Tyre().complete(settings if given else {**settings, **ISOTROPIC})

    def settle(self, request: Request) -> Request:
        """A quarter where symmetry allows it; plain Newton, for a solid has no resultants to predict."""
        whole = super().settle(request)
        symmetric = mirrored(request.settings)
        if request.model == "quarter" and not symmetric:
            raise UsageError(
                f"model 'quarter' needs isotropic plies or cords at 0 or 90 deg, not {request.settings['gamma_deg']:g}"
            )
        return replace(whole, model="quarter" if symmetric and request.model != "full" else "full")

    def build(self, request: Request) -> SolidTyreModel:
        """Raises UsageError for impossible geometry, plies or meshes."""
        settings = request.settings
        laminate, R1, R0, clamp = checked_wall(settings)
        quarter = request.model == "quarter"
        psi, phi = (line[len(line) // 2 :] if quarter else line for line in tyre_lines(request.mesh, clamp))
        per_ply = int(settings.number("per_ply"))
        mesh = SolidMesh.build(torus(R0 - R1, R1), psi, phi, laminate, per_ply=per_ply, periodic=not quarter)
        clamped = np.concatenate([mesh.on(0, side * np.deg2rad(clamp)) for side in (-1, 1)])
        mirrors = ((mesh.on(0, 0.0), 2), *((mesh.on(1, end), 1) for end in (0.0, np.pi))) if quarter else ()
        fixed = mesh.supports((clamped, slice(None)), *mirrors)
        try:
            solid = SolidDiscretisation.build(mesh, laminate, fixed, LAWS[settings.choice("law")])
        except ValueError as error:
            raise UsageError(f"law {settings.choice('law')!r}: {error}") from None
        nodes = np.setdiff1d(np.unique(mesh.outer), clamped)
        coupling = mesh.face_mass(mesh.outer)[nodes][:, nodes] if settings["coupling"] == "consistent" else None
        weights = mesh.face_areas(mesh.outer)[nodes]
        candidates = Candidates(mesh.x[nodes], solid.displacement_operator(nodes), weights, coupling)
        body, wall = SolidModel(solid, inflation(settings)), whole_wall(solid, nodes, request.model)
        return SolidTyreModel(body, wall, candidates, settings.numbers("delta_mm"), foundation(settings), nodes)


@dataclass(frozen=True, eq=False)
class SolidTyreModel(SolidSceneModel, PressedTyre):
    """The stages of the tyre as a solid."""

    body: SolidModel
    nodes: np.ndarray  # mesh node of each candidate


def whole_wall(solid: SolidDiscretisation, nodes: np.ndarray, model: str) -> Wall:
    """The faces of the whole tyre; ``nodes`` of the mesh are the candidates."""
    mesh = solid.mesh
    inner, outer = (_in_order(mesh, np.unique(face)) for face in (mesh.inner, mesh.outer))
    at = mesh.parameter[outer].reshape(len(np.unique(np.round(mesh.parameter[outer, 0], 9))), -1, 3)
    psi, phi = at[:, 0, 0], at[0, :, 1]
    if model == "quarter":
        psi, phi = (np.concatenate([-half[:0:-1], half]) for half in (psi, phi))
    else:
        phi = np.append(phi, np.pi)  # where the ring closes
    part = part_of(model, psi, phi)
    angles = part.view @ mesh.parameter[outer, :2] * part.sign[:, [2, 1]]  # to the last digit

    def faces(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = mesh.x + solid.expand(u)
        return x[inner], x[outer]

    on_face = np.full(len(mesh.x), -1)
    on_face[outer] = np.arange(len(outer))
    return Wall(replace(part, angles=angles), on_face[nodes], faces)


def _in_order(mesh: SolidMesh, face: np.ndarray) -> np.ndarray:
    """Nodes of a face with psi slowest."""
    psi, phi = np.round(mesh.parameter[face, :2], 9).T
    return face[np.lexsort((phi, psi))]


SCENES = (SolidTyre(),)
