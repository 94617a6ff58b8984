"""From a scene that is a solid of triquadratic hexahedra to the same body of bricks. No scene is known here."""

from __future__ import annotations

import numpy as np

from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid.laws import StVenantKirchhoff
from studies.exchange.bricks import Bricks
from studies.exchange.pressure import area_forces
from studies.exchange.problem import Supports
from studies.request import UsageError


def bricks_of(solid: SolidDiscretisation) -> Bricks:
    """Its own mesh; raises UsageError for a law that is not linear between Green strain and the second stress."""
    if not all(isinstance(law, StVenantKirchhoff) for law in solid.laws):
        raise UsageError("law must be 'svk' in a deck: one of svk")
    return Bricks.of(solid.mesh)


def supports_of(solid: SolidDiscretisation, bricks: Bricks) -> Supports:
    """Along the Cartesian axes."""
    kept = np.flatnonzero(bricks.of_mesh >= 0)
    held = solid.fixed[kept[np.argsort(bricks.of_mesh[kept])]]
    nodes = np.flatnonzero(held.any(axis=1))
    return Supports(nodes, np.broadcast_to(np.eye(3), (len(nodes), 3, 3)), held[nodes])


def loads_of(body: SolidModel, bricks: Bricks) -> tuple[np.ndarray, np.ndarray]:
    """Pressure (F,) [MPa] that follows the inner faces, and dead forces (N, 3) [N] on the nodes of the bricks."""
    solid, pressure = body.discretisation, body.pressure
    forces = np.zeros(solid.fixed.size)
    if body.forces is not None:
        forces[solid.free] = body.forces
    nodal = bricks.without_centres(forces.reshape(-1, 3))
    value = np.full(len(bricks.inner), 0.0 if pressure is None else pressure.value)
    if pressure is None or pressure.follower:
        return value, nodal
    return np.zeros_like(value), nodal + area_forces(bricks, value)
