"""A mesh of gmsh with its physical groups; quadrilaterals of first order alone, points and lines for groups.

meshio reads the file and trusts it: what comes out is checked here. It keeps no numbers of nodes and elements, so that
both count from 1 in the order of the file.
"""

import contextlib
import io
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from studies.ask.request import UsageError
from studies.scenes.complete import LARGEST_MESH
from studies.scenes.mesh_file.keywords import LARGEST_FILE, shown
from studies.scenes.mesh_file.mesh_cards import FIRST_ORDER, RECOMBINE

NODES = {"vertex": 1, "line": 2, "quad": 4}  # of the cells that are read
OTHERS = {
    "triangle": f"triangles; {RECOMBINE}",
    "triangle6": f"triangles; {RECOMBINE}, Mesh.ElementOrder = 1",
    **dict.fromkeys(("line3", "quad8", "quad9"), f"elements of second order; {FIRST_ORDER}"),
}


@dataclass(frozen=True, eq=False)
class GmshMesh:
    """x (N, 3).  quads (E, 4): places of nodes.  groups: by name the cells of each kind, of quads their places."""

    x: np.ndarray
    quads: np.ndarray
    groups: dict[str, dict[str, np.ndarray]]

    def nodes_of(self, name: str) -> np.ndarray:
        """Places of all nodes of a group."""
        kinds = self.groups[name]
        parts = [kinds[kind].ravel() for kind in ("vertex", "line") if kind in kinds]
        return np.unique(np.concatenate([*parts, self.quads[kinds.get("quad", np.zeros(0, int))].ravel()]))


def read_mesh(path: Path) -> GmshMesh:
    """Raises UsageError for a file that is not such a mesh, and OSError."""
    mesh = _by_meshio(path)
    x = np.asarray(mesh.points, float)
    if x.ndim != 2 or x.shape[1] != 3 or not np.isfinite(x).all():
        raise UsageError(f"{path.name}: positions of nodes must be three finite numbers each")
    for block in mesh.cells:
        if len(block.data) and block.type not in NODES:
            why = OTHERS.get(block.type, f"elements {shown(block.type)}, understood are quadrilaterals")
            raise UsageError(f"{path.name}: has {why}")
        if len(block.data) and not 0 <= np.min(block.data) <= np.max(block.data) < len(x):
            raise UsageError(f"{path.name}: elements that name nodes which are not there")
    blocks = [(block.type, np.asarray(block.data, int)) for block in mesh.cells]
    quads = np.concatenate([np.zeros((0, 4), int), *(data for kind, data in blocks if kind == "quad")])
    if not 0 < len(quads) <= LARGEST_MESH:
        raise UsageError(f"{path.name}: {len(quads)} quadrilaterals, understood are 1 to {LARGEST_MESH}")
    twice = np.any(np.diff(np.sort(quads, axis=1), axis=1) == 0, axis=1)
    if twice.any():
        raise UsageError(f"{path.name}: element {np.flatnonzero(twice)[0] + 1} has a node twice, it is a triangle")
    return GmshMesh(x, quads, _groups(mesh, blocks))


def _by_meshio(path: Path) -> Any:
    try:
        from meshio import gmsh  # an extra: a deck of keywords needs none
    except ImportError:
        how = "pip install -e '.[mesh]' in the checkout of Footprint"
        raise UsageError(f"{path}: meshes of gmsh need the extra mesh: {how}") from None
    if path.stat().st_size > LARGEST_FILE:
        raise UsageError(f"{path}: larger than {LARGEST_FILE // 10**6} MB")
    stderr = io.StringIO()
    try:
        with warnings.catch_warnings(), contextlib.redirect_stderr(stderr):
            warnings.simplefilter("error")  # of truncated numbers meshio only warns
            mesh = gmsh.read(path)
    except OSError:
        raise
    except Exception as error:  # an arbitrary file may raise any of them
        message = " ".join(f"{type(error).__name__} {error}".split())[:120]
        if "gmsh:physical" in message:
            raise UsageError(f"{path.name}: has more than its groups: save it with Mesh.SaveAll = 0") from None
        raise UsageError(f"{path.name}: is no mesh of gmsh in format 2.2 or 4.1: {message}") from None
    if "not closed" in stderr.getvalue():
        raise UsageError(f"{path.name}: is cut off: {' '.join(stderr.getvalue().split())[:120]}")
    return mesh


def _groups(mesh: Any, blocks: list[tuple[str, np.ndarray]]) -> dict[str, dict[str, np.ndarray]]:
    """Format 4.1 names the cells of a group, 2.2 has its number at each of them."""
    groups = dict[str, dict[str, np.ndarray]]()
    tags = mesh.cell_data.get("gmsh:physical")
    for name, (tag, dimension) in mesh.field_data.items():
        parts, first = dict[str, list[np.ndarray]](), 0
        for k, (kind, data) in enumerate(blocks):
            if name in mesh.cell_sets:
                cells = np.asarray(mesh.cell_sets[name][k], int)
            elif tags is not None and list(NODES).index(kind) == dimension:
                cells = np.flatnonzero(np.asarray(tags[k]) == tag)
            else:
                cells = np.zeros(0, int)
            if len(cells):
                parts.setdefault(kind, []).append(cells + first if kind == "quad" else data[cells])
            first += len(data) if kind == "quad" else 0
        groups[name] = {kind: np.concatenate(each) for kind, each in parts.items()}
    return groups
