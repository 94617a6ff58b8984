"""A deck as a scene: what it says in settings, its shell, its loads, and what is read off."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from contact.newton.solves import RESIDUAL_TOLERANCE
from formulations.discretisation import Discretisation
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.geometry.grid import QuadGrid
from formulations.geometry.surfaces import NodalSurface
from formulations.section.laminate import Laminate
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from studies.ask.request import Request, UsageError, Value
from studies.ask.scene import SOLVER, Reference, SceneModel, Setting
from studies.scenes import SCENES, foundations
from studies.scenes.complete import LARGEST_MESH
from studies.scenes.contact.base import OUTER
from studies.scenes.element import WALL, centred_laminate, check_wall
from studies.scenes.mesh_file import pressed
from studies.scenes.mesh_file.conditions import (
    borne_by,
    cut_in,
    forces_of,
    loads_of,
    moments_of,
    moved_of,
    planes_of,
    supports_of,
)
from studies.scenes.mesh_file.pressed import BESIDE
from studies.scenes.mesh_file.reading import read_deck
from studies.scenes.mesh_file.surface import Mesh
from studies.scenes.mesh_file.wall import first_axes, plies_of, walls_of, walls_told
from studies.scenes.statics import LOAD_FRACTION, Loads, StaticModel, loaded_shell

DEAD, FOLLOWER = "dead", "follower"
MOST_SETS = 8  # whose displacements are read off
PARTS = 4  # of an element along each side, with which the error of the mesh is known
LARGEST_CUT = 10_000  # elements of a mesh that is solved without being asked for


class DeckScene:
    """The shell of a deck; of the mesh NxN each of its elements is cut in N x N on the surface that it describes."""

    references: tuple[Reference, ...] = ()
    models: tuple[str, ...] = ("auto",)
    cut = True

    def __init__(self, path: Path, name: str) -> None:
        self.name = name
        self.deck = read_deck(path)
        self.title = f"shell from {path.name}"
        self.mesh = Mesh.of(self.deck)
        self.mesh = self.mesh.in_planes(planes_of(self.deck, self.mesh))
        self.plies = plies_of(self.deck)
        self.words = words((*self.deck.seen, *self.deck.supports))
        parts = PARTS if PARTS**2 * len(self.mesh.elements) <= LARGEST_CUT else 1
        self.default_mesh: tuple[int, int] = (parts, parts)
        follows = FOLLOWER if self.deck.nonlinear else DEAD
        self.settings: tuple[Setting, ...] = (
            LOAD_FRACTION,
            Setting.positive("shear_correction", 1.0, "factor on the shear stiffness; 1000: Kirchhoff", 1e4),
            Setting.one_of("thickness_strain", THICKNESS_STRAINS, "balanced", "where the thickness strain is sampled"),
            Setting.one_of("membrane", MEMBRANES, "relaxed", "linear modes of the membrane strain"),
            Setting.one_of("pressure", (DEAD, FOLLOWER), follows, "whether pressure keeps its direction"),
            Setting.positive("fold_deg", 20.0, "largest angle between neighbours, of normals and along the rim", 60.0),
            BESIDE,
            *WALL,
            SOLVER,
        )
        self.quantities: Mapping[str, str] = {
            "largest_mm": "largest displacement of all nodes of the deck, mean of both faces",
            "largest_at_node": "number of that node",
            "along_forces_mm": "mean displacement along the forces, sum of F.u over sum of |F|",
            **{f"reaction_{i}_N": f"sum of the forces of the supports along axis {i}" for i in (1, 2, 3)},
            **{
                f"reaction_{i}_{self.words[name]}_N": f"sum of those of the set {name}"
                for name in borne_by(self.deck, self.mesh)
                for i in (1, 2, 3)
            },
        }

    @property
    def measure(self) -> str:
        """That of the step: exact with NLGEOM, else linear."""
        return "exact" if self.deck.nonlinear else "linear"

    def settle(self, request: Request) -> Request:
        """Raises UsageError for a mesh other than NxN, N parts of each element along a side."""
        parts, most = request.mesh[0], math.isqrt(LARGEST_MESH // len(self.mesh.elements))
        if request.mesh != (parts, parts) or parts > most:
            allowed = f"1x1, the mesh of {self.deck.path.name}, or NxN, each of its elements in N x N"
            raise UsageError(f"--mesh {request.mesh_text} must be {allowed}, N up to {most}")
        return replace(request, model="full")

    def build(self, request: Request) -> SceneModel:
        """Half of each force on either face, pressure on the inner one."""
        if not (self.deck.forces or self.deck.pressures or moved_of(self.deck, self.mesh).any()):
            where = self.deck.words("*CLOAD, *DLOAD", "forces", "pressures")
            raise UsageError(f"{self.deck.path.name}: no load: {where}, or --set foundation=plane")
        shell, reading, loads = self._loaded(request)
        return DeckModel.of(request, shell, reading, **loads)

    def _loaded(self, request: Request) -> tuple[Discretisation, _Reading, Loads]:
        """The shell, what is read off it, and its loads."""
        folds = request.number("fold_deg")
        self.mesh.check_folds(folds)
        deck, mesh = cut_in(self.deck, self.mesh, request.mesh[0], folds)
        grid = QuadGrid.over(mesh.elements)
        supports = supports_of(deck, mesh, grid)
        if supports.held.all():
            raise UsageError(f"{mesh.file}: every displacement is held")
        surface = replace(NodalSurface.of(mesh.middle, mesh.normals, first_axes(deck, mesh)), frames=mesh.axes)
        laminates = self._laminates(request)
        walls = walls_of(deck, mesh, laminates) if len(laminates) > 1 or deck.thickness else None
        kinematics = MEASURES[request.measure].kinematics
        supported = (*supports.masks, kinematics, "quads")
        surfaces = check_wall(request, laminates[0])
        try:
            shell = Discretisation.build(
                surface, grid, laminates[0], *supported, ordered=True, walls=walls, surfaces=surfaces
            )
        except ValueError as error:
            raise UsageError(f"{mesh.file}: {error}") from None
        height = np.full(len(mesh.numbers), laminates[0].thickness)
        if walls is not None:
            height = walls.at_nodes(mesh.elements, len(mesh.numbers))
        loads = loads_of(deck, mesh, height, request.measure, follower=request.choice("pressure") == FOLLOWER)
        left = max(request.number("tolerance"), RESIDUAL_TOLERANCE)
        forces = forces_of(self.deck, mesh)
        borne = {self.words[name]: share for name, share in borne_by(deck, mesh).items()}
        reading = _Reading(shell, self.mesh.numbers, forces, self._sets(), borne, left)
        return shell, reading, loads

    def _laminates(self, request: Request) -> list[Laminate]:
        return [centred_laminate(request, *plies) for plies in self.plies]

    def _sets(self) -> dict[str, np.ndarray]:
        """Sets that loads or output requests name, as far as they have elements; places in all meshes."""
        named = {name: self.mesh.at(self.deck.node_sets[name]) for name in self.deck.seen}
        return dict([(self.words[name], nodes) for name, nodes in named.items() if len(nodes)][:MOST_SETS])

    def told(self) -> Iterator[str]:
        """What was read, for people."""
        deck, mesh = self.deck, self.mesh
        unused = f", {mesh.unused} nodes of no element left out" if mesh.unused else ""
        yield f"read {mesh.file}: {len(mesh.numbers)} nodes, {len(mesh.elements)} quadrilaterals{unused}"
        given = np.count_nonzero(mesh.given)
        yield f"normals: {given} from the deck, {len(mesh.given) - given} from the positions around"
        ridges = sum(len(at_node) > 1 for at_node in deck.normals.values())
        if ridges:
            yield f"several normals at {ridges} nodes: their mean; a fold that is rounded off when elements are cut"
        yield from walls_told(deck, self.plies)
        kinds = dict[str, int]()
        for degrees in deck.degrees.values():
            kind = "".join(map(str, sorted(degrees)))
            kinds[kind] = kinds.get(kind, 0) + 1
        if deck.systems:
            yield f"axes of *TRANSFORM at {len(deck.systems)} nodes"
        yield "supports: " + ", ".join(f"degrees {kind} at {count} nodes" for kind, count in sorted(kinds.items()))
        for loads, what, unit in (
            (forces_of(self.deck, mesh), "forces", "N"),
            (moments_of(self.deck, mesh), "moments", "N mm"),
        ):
            if loads.any():
                total = " ".join(f"{x + 0.0:.6g}" for x in loads.sum(axis=0))
                count = np.count_nonzero(loads.any(axis=1))
                yield f"{what} on {count} nodes, in all {total} {unit}, dead, on these nodes however they are cut"
        moved = np.count_nonzero(moved_of(deck, mesh).any(axis=1))
        if moved:
            yield f"supports are moved at {moved} nodes, in one step unless --steps asks for more"
        if deck.pressures:
            low, high = min(deck.pressures.values()), max(deck.pressures.values())
            span = f"{low:g}" if low == high else f"{low:g} to {high:g}"
            yield f"pressure {span} MPa along the normals of {len(deck.pressures)} elements"
        rotations = "finite" if deck.nonlinear else "small"
        yield "mesh NxN cuts each element in N x N, on the curved surface of positions and normals; 1x1 cuts none"
        yield f"step: {rotations} rotations, measure {self.measure} unless another is asked for"
        if deck.silent:
            silent = ", ".join(f"*{name}" for name in sorted(deck.silent))
            yield f"read, without effect: {silent}"


def words(names: Iterable[str]) -> dict[str, str]:
    """The names of sets as parts of names of quantities: of those that would be alike, later ones have a number."""
    made: dict[str, str] = {}
    for name in dict.fromkeys(names):
        plain = word = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in name)
        number = 1
        while word in made.values():
            number += 1
            word = f"{plain}_{number}"
        made[name] = word
    return made


def lengths(x: np.ndarray) -> np.ndarray:
    """Of vectors (N, 3), those whose squares are not numbers any more, too."""
    return np.asarray(np.hypot.reduce(x, axis=1))


@dataclass(frozen=True, eq=False)
class _Reading:
    """Displacements are means of both faces; the forces of supports are read by :class:`DeckModel`.

    numbers: of the nodes of the deck, which come first.  sets, supports: by the word of a set its nodes, and what it
    bears of each node (N,).  left: what Newton's iteration, or rounding, may leave of the forces in balance.
    """

    shell: Discretisation
    numbers: np.ndarray
    forces: np.ndarray
    sets: Mapping[str, np.ndarray]
    supports: Mapping[str, np.ndarray]
    left: float

    def __call__(self, shell: ShellModel, u: np.ndarray) -> dict[str, float]:
        middle = np.mean(self.shell.cartesian(u, shell.prescribed), axis=0)
        size = lengths(middle[: len(self.numbers)])
        largest = int(np.argmax(size))
        readings: dict[str, float] = {"largest_mm": float(size[largest]), "largest_at_node": int(self.numbers[largest])}
        total = np.sum(lengths(self.forces))
        if total > 0:
            readings["along_forces_mm"] = float(np.sum(self.forces / total * middle))
        for name, nodes in self.sets.items():
            readings |= {f"u{i + 1}_{name}_mm": float(x) for i, x in enumerate(middle[nodes].mean(axis=0))}
        return readings

    def with_reactions(self, shell: ShellModel, u: np.ndarray, fraction: float) -> dict[str, float]:
        """Under a fraction of the loads; forces of the deck on what a support holds are borne by the support.

        A sum that supports in balance with each other leave below ``left`` is 0.
        """
        body = shell.discretisation
        axes = body.surface.frame(*body.grid.nodes.T)
        forces = np.einsum("nix,nx->ni", axes, self.forces)
        on_supports = np.where(body.map.held | body.map.hinged, np.repeat(0.5 * forces, 2, axis=1), 0.0)
        shell = shell.scaled(fraction)
        borne = shell.reactions(u) - fraction * on_supports
        at_nodes, least = np.einsum("nif,nix->nx", borne.reshape(-1, 3, 2), axes), self.left * np.abs(borne).sum()
        readings = self(shell, u)
        for name, of in (("", np.ones(len(axes))), *((f"_{name}", of) for name, of in self.supports.items())):
            total = of @ at_nodes
            total = np.where(np.abs(total) > least, total, 0.0)
            readings |= {f"reaction_{i + 1}{name}_N": float(x) for i, x in enumerate(total)}
        return readings


class DeckModel(StaticModel):
    """With the forces of the supports."""

    def moved(self, t: float) -> DeckModel:
        """With the displacements of the supports at that fraction."""
        prescribed = self.shell.prescribed
        return self if prescribed is None else replace(self, shell=replace(self.shell, prescribed=t * prescribed))

    def _displacements(self, u: np.ndarray, fraction: float) -> dict[str, float]:
        assert isinstance(self.measure_at, _Reading)
        return self.measure_at.with_reactions(self.shell, u, fraction)


class PressedDeckScene(DeckScene):
    """The same pressed on a rigid foundation, see :mod:`studies.scenes.mesh_file.pressed`."""

    slides: bool = True

    def __init__(self, path: Path, name: str) -> None:
        super().__init__(path, name)
        self.settings = (*pressed.SETTINGS, *(each for each in self.settings if each is not BESIDE))
        self.quantities = {**pressed.QUANTITIES, **self.quantities}

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """With the measures of its foundation; raises UsageError on those of another."""
        return foundations.complete(settings)

    def build(self, request: Request) -> SceneModel:
        """The foundation stands where it first touches the deck cut to its own default, on all meshes."""
        body, reading, loads = self._loaded(request)
        if "prescribed" in loads:
            raise UsageError(f"{self.deck.path.name}: supports that move, and a foundation, are not supported together")
        deck, finest = cut_in(self.deck, self.mesh, max(self.default_mesh), request.number("fold_deg"))
        face = pressed.touching_face(finest.middle, finest.normals, pressed.direction(request.settings))
        thickness = walls_of(deck, finest, self._laminates(request)).at_nodes(finest.elements, len(finest.numbers))
        x, over = finest.middle + (0.5 if face == OUTER else -0.5) * thickness[:, None] * finest.normals, None
        if "over_node" in request.settings:
            at = self.mesh.at([int(request.number("over_node"))])
            if not len(at):
                raise UsageError(f"over_node = {request.number('over_node'):g} is not a node of {self.deck.path.name}")
            over = x[at[0]]
        foundation = pressed.placed(request, x, over)
        shell = loaded_shell(body, request, **loads)
        return pressed.pressed(request, shell, face, foundation, reading.with_reactions)


@contextmanager
def entered(name: str, *, on_foundation: bool = False) -> Iterator[DeckScene]:
    """The scene of a file in the catalogue as long as it lasts; raises UsageError if it is not a deck, and OSError."""
    scene = (PressedDeckScene if on_foundation else DeckScene)(Path(name), name)
    SCENES[name] = scene
    try:
        yield scene
    finally:
        del SCENES[name]
