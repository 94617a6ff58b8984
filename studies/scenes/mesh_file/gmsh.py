"""A mesh of gmsh with its physical groups; quadrilaterals of first order alone, points and lines for groups.

meshio reads the file and trusts it: what comes out is checked here. It keeps no numbers of nodes and elements, so that
both count from 1 in the order of the file.

A mesh of gmsh and the TOML beside it, of the same name, as the record that a deck of keywords makes, too.

::

    read_off = ["tip"]                    # groups whose displacements are wanted
    finite_rotations = true               # false by default

    [materials]                           # MPa; or E1, E2, nu12, G12, G23: fibres along 1
    steel = {E = 210000.0, nu = 0.3}

    [sections]                            # mm; of quadrilaterals; plies from inside: thickness, material, degrees
    skin = {thickness = 1.0, material = "steel"}
    web = {plies = [[0.5, "steel", 0.0], [0.5, "steel", 0.0]], axis = [1.0, 0.0, 0.0]}

    [supports]                            # degrees 1 to 6, or ENCASTRE, PINNED, XSYMM, YSYMM, ZSYMM
    root = "ENCASTRE"
    side = [1, 5, 6]

    [forces]                              # N in all, along x, y, z: evenly on points, by length on lines
    tip = [0.0, 0.0, -10.0]

    [pressures]                           # MPa along the normals
    skin = 0.01
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
from studies.scenes.mesh_file.cards import FIRST_ORDER, NAMED, RECOMBINE
from studies.scenes.mesh_file.deck import Deck, Elastic, Layer, Section
from studies.scenes.mesh_file.keywords import LARGEST, LARGEST_FILE, RANGE, Said, listed, shown

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
    if x.ndim != 2 or x.shape[1] != 3 or not (np.abs(x) <= LARGEST).all():
        raise UsageError(f"{path.name}: positions of nodes must be three numbers in {RANGE} each")
    for block in mesh.cells:
        if len(block.data) and block.type not in NODES:
            why = OTHERS.get(block.type, f"elements {shown(block.type)}, only quadrilaterals are supported")
            raise UsageError(f"{path.name}: has {why}")
        if len(block.data) and not 0 <= np.min(block.data) <= np.max(block.data) < len(x):
            raise UsageError(f"{path.name}: elements that name nodes which are not there")
    blocks = [(block.type, np.asarray(block.data, int)) for block in mesh.cells]
    quads = np.concatenate([np.zeros((0, 4), int), *(data for kind, data in blocks if kind == "quad")])
    if not 0 < len(quads) <= LARGEST_MESH:
        raise UsageError(f"{path.name}: {len(quads)} quadrilaterals, there must be 1 to {LARGEST_MESH}")
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
        raise UsageError(f"{path.name}: is not a mesh of gmsh in format 2.2 or 4.1: {message}") from None
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


TABLES = ("materials", "sections", "supports", "forces", "pressures")
FIBRES = ("E1", "E2", "nu12", "G12", "G23")


def read_gmsh(path: Path) -> Deck:
    """Raises UsageError naming the key of what is not understood, and OSError."""
    beside = path.with_suffix(".toml")
    if path.is_file() and not beside.is_file():
        raise UsageError(
            f"{path}: needs {beside.name} beside it, with materials, sections, supports and loads of its groups"
        )
    mesh, top = read_mesh(path), Said.of(beside).table(*TABLES, "read_off", "finite_rotations")
    for name in TABLES[:3]:
        if name not in top:
            raise UsageError(f"{beside.name}: has no table {name}")
    tables = {name: top[name].table() if name in top else {} for name in TABLES}
    deck = Deck(path, static=True, steps=1, ended=True, beside=beside)
    deck.nodes = {i: (x, y, z) for i, (x, y, z) in enumerate(mesh.x.tolist(), 1)}
    deck.elements = {i: tuple(corners) for i, corners in enumerate((mesh.quads + 1).tolist(), 1)}
    deck.nonlinear = "finite_rotations" in top and top["finite_rotations"].flag()
    deck.materials = {name: _material(each) for name, each in tables["materials"].items()}
    for name, each in tables["sections"].items():
        _section(deck, name, each, _quads(mesh, name, each))
    bare = [each for each in deck.elements if each not in deck.section_of]
    if bare:
        raise UsageError(f"{beside.name}: sections leave out the elements {listed(bare)}")
    for name, each in tables["supports"].items():
        held, nodes = _degrees(each), _nodes(mesh, name, each)
        deck.supports[name] = dict.fromkeys(nodes, 1.0)
        for node in nodes:
            deck.degrees.setdefault(node, set()).update(held)
    for name, each in tables["forces"].items():
        _force(deck, mesh, name, each)
    for name, each in tables["pressures"].items():
        for element in _quads(mesh, name, each):
            if element in deck.pressures:
                each.refuse(f"is a second pressure on element {element}")
            deck.pressures[element] = each.real()
    for each in top["read_off"].items() if "read_off" in top else ():
        deck.node_sets[each.text()] = _nodes(mesh, each.text(), each)
        deck.see(each.text())
    deck.check()
    return deck


def _known(mesh: GmshMesh, name: str, said: Said) -> str:
    if name not in mesh.groups:
        said.refuse(
            f"is not a physical group of the mesh, which has {listed(list(map(shown, mesh.groups)), 8) or 'none'}"
        )
    return name


def _nodes(mesh: GmshMesh, name: str, said: Said) -> list[int]:
    return list((mesh.nodes_of(_known(mesh, name, said)) + 1).tolist())


def _quads(mesh: GmshMesh, name: str, said: Said) -> list[int]:
    kinds = mesh.groups[_known(mesh, name, said)]
    if "quad" not in kinds:
        said.refuse("must be a group of quadrilaterals")
    return list((kinds["quad"] + 1).tolist())


def _material(said: Said) -> Elastic:
    if "E" in said.table(*FIBRES, "E", "nu"):
        return Elastic("ISOTROPIC", tuple(each.real() for each in said.needs("E", "nu")), said)
    e1, e2, nu12, g12, g23 = (each.real() for each in said.needs(*FIBRES))
    return Elastic("LAMINA", (e1, e2, nu12, g12, g12, g23), said)


def _section(deck: Deck, name: str, said: Said, elements: list[int]) -> None:
    table = said.table("thickness", "material", "plies", "axis")
    axis = "axis" in table
    if axis:
        deck.orientations[name] = (tuple(each.real() for each in table["axis"].items(3)), 0.0)
    if "plies" in table:
        laminate = Said(said.file, said.key, {key: each.value for key, each in table.items() if key != "axis"})
        layers = [_layer(deck, *each.items(3)) for each in laminate.needs("plies")[0].items()]
    else:
        thickness, material = said.needs("thickness", "material")
        layers = [_layer(deck, thickness, material, Said(said.file, said.key, 0.0))]
    if not layers:
        said.refuse("has no plies")
    number = deck.sections.setdefault(Section(tuple(layers), name if axis else "", False), len(deck.sections))
    twice = [each for each in elements if each in deck.section_of]
    if twice:
        said.refuse(f"is the second section of the elements {listed(twice)}")
    deck.section_of.update(dict.fromkeys(elements, number))


def _layer(deck: Deck, thickness: Said, material: Said, angle: Said) -> Layer:
    if material.text() not in deck.materials:
        material.refuse(f": there is no material {shown(material.text())}")
    return Layer(thickness.real(), material.text(), angle.real(), thickness)


def _degrees(said: Said) -> set[int]:
    if isinstance(said.value, str):
        return set(NAMED.get(said.value) or said.refuse(f": must be one of {', '.join(NAMED)}, or a list of 1 to 6"))
    for each in said.items():
        if each.value not in range(1, 7) or isinstance(each.value, bool):
            each.refuse("must be one of 1 to 6")
    return {int(each.real()) for each in said.items()} or said.refuse("holds nothing")


def _force(deck: Deck, mesh: GmshMesh, name: str, said: Said) -> None:
    """F_i = F l_i/l with half of the lengths of the lines at a node; evenly on points."""
    total = np.array([each.real() for each in said.items(3)])
    kinds = mesh.groups[_known(mesh, name, said)]
    share = np.zeros(len(mesh.x))
    if "line" in kinds:
        ends = kinds["line"]
        lengths = np.linalg.norm(mesh.x[ends[:, 1]] - mesh.x[ends[:, 0]], axis=-1)
        np.add.at(share, ends, 0.5 * lengths[:, None])
    elif "vertex" in kinds:
        share[kinds["vertex"].ravel()] = 1.0
    if not share.any():
        said.refuse("must be a group of points, or of lines that have a length")
    for node in np.flatnonzero(share).tolist():
        forces = deck.forces.setdefault(node + 1, {})
        for degree, value in enumerate((total * share[node] / share.sum()).tolist(), 1):
            forces[degree] = forces.get(degree, 0.0) + value
