"""Which part of a tyre is solved, and what the whole is made of: symmetries as signed maps on one grid.

The contact normal e_x at (psi, phi) = (0, 0) is an axis of symmetry of every tyre here: a turn by 180 degrees about it
takes (psi, phi) to (-psi, -phi), and plies of any constant angle to themselves. Two mirror planes, psi = 0 and phi = 0,
are there only without angle plies. Inflation is the same all around, and one column of elements shows it.
A part cannot leave its symmetry: it follows the symmetric path past a bifurcation that breaks it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from formulations.conditions.dof_map import Images
from formulations.geometry.grid import Grid, TensorGrid
from studies.ask.request import Request, Value
from studies.ask.scene import UsageError
from studies.scenes.element import moved_nodes, tree_over

MODELS = ("auto", "full", "half", "mirror", "quarter", "sector", "axisymmetric")
TURNED = np.array([1.0, -1.0, -1.0])  # a turn by 180 degrees about e_x: Cartesian components
TURN_OF_FRAME = np.array([-1.0, -1.0, 1.0])  # and those along a1, a2, normal


@dataclass(frozen=True, eq=False)
class Part:
    """The grid of what is solved.

    A sector ends at |phi| = cut with the seam that a half has at pi: the tyre has its contact again every 2 cut, which
    is smooth, in equilibrium with itself, and leaves inflation as it is. Its wall shows what lies inside the cut.

    edges: supports of psi at both ends, then of phi, see :meth:`Supports.of_edges`.  images: nodes on a seam that
    mirror others.  copies: how many such parts show the whole patch.  angles (N, 2), shape: where all lines of the
    whole tyre meet, psi slowest; view (N, n), sign (N, 3): what they take of the part's nodes, of one or of the corners
    of the element that they lie in, and the signs of x, y, z there.
    """

    grid: Grid
    edges: tuple[str, str, str, str]
    images: Images | None
    copies: int
    angles: np.ndarray
    shape: tuple[int, int]
    view: sparse.csr_matrix
    sign: np.ndarray

    @property
    def cut(self) -> float:
        """The seam opposite the contact [rad]: pi unless the part is a sector."""
        return float(np.max(np.abs(self.angles[:, 1])))

    @property
    def whole(self) -> bool:
        """Whether it shows the tyre all around."""
        return self.cut > np.pi - 1e-9

    def merging(self) -> np.ndarray:
        """(n,) the node of the part that each of its nodes shares displacements with, itself or the one it mirrors."""
        merged = np.arange(self.grid.n_nodes)
        if self.images is not None:
            merged[self.images.nodes] = self.images.of
        return merged


def mirrored(settings: Mapping[str, Value]) -> bool:
    """Whether the plies have the two mirror planes: isotropic, or cords along or across the meridian."""
    return "E_MPa" in settings or settings["gamma_deg"] in (-90.0, 0.0, 90.0)


def base_of(settings: Mapping[str, Value]) -> str:
    """The smallest part that shows the whole tyre exactly."""
    return "quarter" if mirrored(settings) else "half"


def settle_model(model: str, settings: Mapping[str, Value]) -> tuple[str, str]:
    """The model that will be solved, the smallest for "auto", and why; raises UsageError for one that is not valid."""
    if model in ("auto", "axisymmetric") and settings.get("delta_mm") == (0.0,):
        return "axisymmetric", "delta_mm = 0 is inflation alone, which is axisymmetric"
    if model == "axisymmetric":
        raise UsageError("model 'axisymmetric' needs delta_mm = 0: contact is not axisymmetric")
    if "mu" in settings:
        if model not in ("auto", "full"):
            raise UsageError(f"model {model!r} has no friction: friction needs the whole tyre, model 'full'")
        return "full", "friction acts on the whole tyre"
    if mirrored(settings):
        plies = "isotropic plies" if "E_MPa" in settings else f"cords at {settings['gamma_deg']:g} deg"
        why = f"{plies} leave two mirror planes"
    else:
        plies = f"plies at +-{settings['gamma_deg']:g} deg"
        why = f"{plies} leave a turn by 180 deg about the contact normal, but no mirror plane"
        if model in ("mirror", "quarter"):
            raise UsageError(f"model {model!r} needs isotropic plies or cords at 0 or 90 deg: {why}")
    if model == "auto":
        return base_of(settings), why
    return model, "as asked"


def part_of(model: str, psi: np.ndarray, phi: np.ndarray) -> Part:
    """The part of the tyre with the grid lines psi (n1 + 1,) and phi (n2 + 1,), both symmetric about 0, n1, n2 even.

    Where phi ends before pi, the part is a sector.
    """
    n1, n2 = len(psi) - 1, len(phi) - 1
    lines = np.meshgrid(psi, phi[:n2], indexing="ij")
    angles, shape = np.stack([line.ravel() for line in lines], axis=-1), (n1 + 1, n2)
    row, column = (index.ravel() for index in np.indices(shape))
    behind, below = angles[:, 1] < -1e-12, angles[:, 0] < -1e-12  # phi < 0, psi < 0
    sign = np.ones((len(angles), 3))
    half_psi, half_phi = model in ("mirror", "quarter"), model in ("half", "quarter")
    if half_psi:
        psi, row = psi[n1 // 2 :], np.abs(row - n1 // 2)
        sign[below, 2] = -1.0
    if half_phi:
        phi, column = phi[n2 // 2 :], np.abs(column - n2 // 2)
    grid = Grid.tensor(psi, phi, periodic=not half_phi)
    images = None
    if model == "quarter":
        sign[behind, 1] = -1.0
    if model == "half":
        row = np.where(behind, n1 - row, row)
        sign[behind] = TURNED
        images = _turned(grid)
    inside, seam = "symmetric" if half_psi else "clamped", "symmetric" if model == "quarter" else "free"
    copies, node = 2 ** (half_psi + half_phi), row * grid.node_shape[1] + column
    view = sparse.csr_matrix((np.ones(len(node)), node, np.arange(len(node) + 1)), shape=(len(node), grid.n_nodes))
    return Part(grid, (inside, "clamped", seam, seam), images, copies, angles, shape, view, sign)


def locally_refined(part: Part, request: Request, model: str) -> Part:
    """The part with the leaves of the request over its elements; of a half they are symmetric under psi -> -psi."""
    assert isinstance(part.grid, TensorGrid)
    tree = tree_over(request, *part.grid.lines, periodic=part.grid.periodic)
    grid = tree.grid()
    psi, phi = (np.unique(grid.nodes[:, axis]) for axis in (0, 1))
    if part.grid.periodic:
        phi = np.append(phi, part.grid.lines[1][-1])
    psi, phi = (line if line[0] < 0 else np.concatenate([-line[:0:-1], line]) for line in (psi, phi))
    fine = part_of(model, psi, phi)
    view = fine.view @ tree.interpolation(grid, fine.grid.nodes)
    return replace(fine, grid=grid, images=_turned(grid) if model == "half" else None, view=sparse.csr_matrix(view))


def distorted(part: Part, request: Request) -> Part:
    """The part with its nodes moved as asked; those of a seam that mirrors itself stay, and so do their images."""
    images = part.images
    grid = moved_nodes(request, part.grid, None if images is None else np.union1d(images.nodes, images.of))
    angles = np.copysign(part.view @ grid.nodes, part.angles) if grid is not part.grid else part.angles
    return replace(part, grid=grid, angles=angles)


def _turned(grid: Grid) -> Images:
    """On the seams phi = 0 and pi, or the cut, the nodes with psi <= 0 mirror those with -psi."""
    nodes, of = [], []
    for end in grid.ends[1]:
        seam = grid.on_line(1, end)
        seam = seam[np.argsort(grid.nodes[seam, 0])]
        first = grid.nodes[seam, 0] <= 1e-12
        nodes.append(seam[first])
        of.append(seam[::-1][first])
    at = np.concatenate(nodes)
    return Images(at, np.concatenate(of), np.broadcast_to(TURN_OF_FRAME, (len(at), 3)))


def column_of(part: Part) -> Part:
    """One column of elements with the psi lines of the part, its two sides the same: a state that is equal all around.

    It is as wide as the elements at the crown.
    """
    assert isinstance(part.grid, TensorGrid)
    grid = Grid.tensor(part.grid.lines[0], np.unique(np.abs(part.angles[:, 1]))[:2])
    second = np.arange(1, grid.n_nodes, 2)  # its displacements are those of the first side, in the turning frame
    images = Images(second, second - 1, np.ones((len(second), 3)))
    return replace(part, grid=grid, edges=(*part.edges[:2], "free", "free"), images=images)
