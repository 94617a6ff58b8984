"""Solids of every law: the crushed ring beside shells, and what small strain in the law is worth.

The crushed ring is solved on sequences of meshes, and with its data as far off as known; what the differences to the
test are made of is worked out in :mod:`studies.analysis.uncertainty`. The other bodies have St. Venant-Kirchhoff's law
beside Hencky's, on one mesh for both, so that their meshes' errors are nearly the same. Loads go from small strain to
more than a shell's law is made for. What is bent has as much of the strain with one sign as with the other.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.continuation.load_stepping import follow
from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.geometry.surfaces import Plate, Surface, cylinder
from formulations.loads import Pressure
from formulations.section.laminate import LAWS, Laminate, Ply
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.experiments import Row, tabulated
from studies.scenes.complete import Cell, complete
from studies.scenes.contact.crushed_ring import DATA
from studies.scenes.contact.crushed_ring_solid import SolidRingModel
from studies.scenes.tyre.solid import SolidTyreModel
from studies.scenes.walk import walk
from studies.solving.result import SOLVED
from studies.solving.solve import solve

SHELL, SOLID = "crushed-ring", "crushed-ring-solid"
NO_NU = {"nu": "0", "E_MPa": repr(DATA["E_MPa"] / (1 - DATA["nu"] ** 2))}  # the other way to plane strain
# Half of the last digit in which the data are given: 407 N/cm^2, 0.48, 6.35 and 4.15 cm
HALF_DIGIT = {"E_MPa": 0.005, "nu": 0.005, "outer_mm": 0.05, "inner_mm": 0.05}
MESHES, INPUTS, STATES = "meshes", "inputs", "states"
COMPARED = ("svk", "hencky")
SOLID_MESHES, SHELL_MESHES = ((24, 3), (32, 4), (48, 6), (64, 8)), (32, 64, 128, 256)


@dataclass(frozen=True)
class Body:
    """A way to compute the ring: kind "solid" or "shell", its law or its measure, and settings beyond."""

    name: str
    kind: str
    of: str
    settings: Mapping[str, str]

    def cell(self, n: int, through: int = 0, across: int = 1, more: Mapping[str, str] | None = None) -> Cell:
        """The request on n elements around the quarter; more: other settings."""
        settings, mesh = {**self.settings, **(more or {})}, f"{across}x{n}"
        if self.kind == "solid":
            return Cell(self.name, SOLID, {"mesh": mesh}, {"law": self.of, "per_ply": f"{through}", **settings})
        return Cell(self.name, SHELL, {"mesh": mesh, "measure": self.of}, settings)


SOLIDS = tuple(Body(f"solid {law}", "solid", law, {}) for law in ("svk", "hencky", "neo-hooke"))
SHELLS = tuple(
    Body(f"shell {measure}{suffix}", "shell", measure, settings)
    for suffix, settings in (("", {}), (", ν = 0", NO_NU))
    for measure in ("exact", "von-karman")
)


@tabulated
def crushed_ring_study(
    solids: Iterable[tuple[int, int]] = SOLID_MESHES, shells: Iterable[int] = SHELL_MESHES
) -> Iterator[Row]:
    """A row for each body, mesh and travel: study, body, kind, of, input, change, mesh, size, delta_mm, force_N.

    least_stretch, largest_stretch: of solids.  study: "meshes"; "inputs": a datum changed by half its last digit
    ``change`` [in its unit], by the shell of the exact measure; "states": Hencky's solid with free sides, in three
    dimensions.  Raises RuntimeError where one does not converge.
    """
    solid_meshes, shell_meshes = tuple(solids), tuple(shells)
    for body, (n, through) in product(SOLIDS, solid_meshes):
        yield from _solved(body, body.cell(n, through), MESHES, n)
    for body, n in product(SHELLS, shell_meshes):
        yield from _solved(body, body.cell(n), MESHES, n)
    n, exact = shell_meshes[1], SHELLS[0]
    for key, half in HALF_DIGIT.items():
        for change in (-half, half):
            yield from _solved(exact, exact.cell(n, more={key: repr(DATA[key] + change)}), INPUTS, n, key, change)
    (n, through), hencky = solid_meshes[0], SOLIDS[1]
    yield from _solved(hencky, hencky.cell(n, through, 2, {"state": "3d"}), STATES, n, "3d")


def _solved(body: Body, cell: Cell, study: str, n: int, key: str = "", change: float = np.nan) -> list[Row]:
    """A row a travel."""
    result = solve(*complete(cell.scene, cell.settings, **cell.options))
    if result.verdict not in SOLVED:
        raise RuntimeError(f"{cell.command}: {result.verdict}, {result.reason}")
    own = {"study": study, "body": body.name, "kind": body.kind, "of": body.of, "input": key, "change": change}
    own |= {"mesh": cell.options["mesh"], "size": 1 / n}
    read = ("delta_mm", "force_N", "least_stretch", "largest_stretch")
    about = {"command": cell.command}
    return [own | {name: step.get(name, np.nan) for name in read} | about for step in result.steps]


NU = 0.45  # of the bodies made here, with Young's modulus 1
Point = tuple[float, float, float]  # load, what is compared, largest logarithmic strain
MEMBRANE, BENDING = "membrane", "bending"


@dataclass(frozen=True)
class Specimen:
    """A loaded body: what is compared in words, how it carries, and solve(law) -> its points, load by load."""

    name: str
    quantity: str
    carries: str
    solve: Callable[[str], Iterator[Point]]


@tabulated
def law_strain_study(specimens: tuple[Specimen, ...] | None = None) -> Iterator[Row]:
    """A row for each specimen, load and law: specimen, carries, quantity, load, law, value, strain.

    strain: the largest principal logarithmic strain, by size, at the Gauss points of the body.
    """
    for each, law in product(SPECIMENS if specimens is None else specimens, COMPARED):
        for load, value, strain in each.solve(law):
            row = {"specimen": each.name, "carries": each.carries, "quantity": each.quantity, "load": load, "law": law}
            yield row | {"value": value, "strain": strain}


def largest_strain(body: SolidDiscretisation, u: np.ndarray) -> float:
    """Largest |ln of a principal stretch| at the free displacements u (n,)."""
    return float(np.max(np.abs(np.log(body.stretches(body.expand(u))))))


def scene_points(
    scene: str, mesh: str, settings: Mapping[str, str], stage: str, quantity: str, law: str
) -> Iterator[Point]:
    """What a scene of a solid reports in one of its stages; raises RuntimeError where a load is not reached."""
    built, request = complete(scene, {**settings, "law": law}, mesh)
    model = built.build(request)
    assert isinstance(model, SolidTyreModel | SolidRingModel)
    for visited in walk(model.stages(), Semismooth()):
        if not visited.converged:
            raise RuntimeError(f"{scene} with {law}: {visited.said}")
        if visited.stage.name == stage:
            t = visited.point.requested
            value = visited.stage.observe(visited.problem, visited.state, t).quantities[quantity]
            yield t, value, largest_strain(model.body.discretisation, visited.state.u)


def tube(law: str, pressures: tuple[float, ...] = (0.002, 0.005, 0.01, 0.02)) -> Iterator[Point]:
    """A tube of h/R = 0.1 in plane strain under inner pressure [E]; the growth of its outer radius [R]."""
    mesh, laminate = _wall(cylinder(1.0), np.array([0.0, 0.1]), np.linspace(0, np.pi / 2, 5), 0.1)
    fixed = mesh.supports((slice(None), 2), (mesh.on(1, 0.0), 1), (mesh.on(1, np.pi / 2), 0))
    body = SolidDiscretisation.build(mesh, laminate, fixed, LAWS[law])
    loaded = SolidModel(body, Pressure(1.0, follower=True, area="face"))
    side = np.intersect1d(mesh.on(1, 0.0), mesh.on(2, 0.05))
    yield from _path(loaded, pressures, lambda u: float(body.expand(u)[side, 0].mean()))


def strip(thickness: float, law: str, loads: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)) -> Iterator[Point]:
    """A strip of length 10 clamped at one end, sheared at the other [E I/L^2], plane strain; its deflection [L]."""
    length = 10.0
    mesh, laminate = _wall(Plate(), np.linspace(0, length, 61), np.array([0.0, 1.0]), thickness)
    fixed = mesh.supports((slice(None), 1), (mesh.on(0, 0.0), slice(None)))
    body, tip = SolidDiscretisation.build(mesh, laminate, fixed, LAWS[law]), mesh.on(0, length)
    forces = np.zeros((len(mesh.x), 3))
    forces[tip, 2] = thickness**3 / (12 * (1 - NU**2)) / length**2 / len(tip)
    loaded = SolidModel(body, forces=forces.ravel()[body.free])
    yield from _path(loaded, loads, lambda u: float(body.expand(u)[tip, 2].mean()) / length)


def _wall(surface: Surface, lines1: np.ndarray, lines2: np.ndarray, thickness: float) -> tuple[SolidMesh, Laminate]:
    """An isotropic wall with E = 1, two elements through it."""
    laminate = Laminate.single(Ply.isotropic(1.0, NU, thickness))
    return SolidMesh.build(surface, lines1, lines2, laminate, per_ply=2), laminate


def _path(body: SolidModel, loads: tuple[float, ...], read: Callable[[np.ndarray], float]) -> Iterator[Point]:
    """Load by load from rest; raises RuntimeError where one is not reached."""
    n = body.discretisation.n_free

    def problem_at(load: float) -> ContactProblem:
        return without_contact(body.scaled(load).linearise, n)

    for point in follow(problem_at, 0.0, loads, Semismooth(), ContactSolution.at_rest(n, 0)):
        if not point.outcome.converged:
            raise RuntimeError(f"load {point.requested:g}: {point.outcome.value}")
        yield point.requested, read(point.solution.u), largest_strain(body.discretisation, point.solution.u)


_TYRE = {"delta_mm": "5,10,20"}
_THICK, _THIN = {"per_ply": "3"}, {"per_ply": "2", "inner_mm": "58.5"}
_FORCE = "force"
SPECIMENS = (
    Specimen("tube, h/R = 0.1, inflated", "growth", MEMBRANE, tube),
    Specimen(
        "isotropic tyre, inflated",
        "growth of the equator",
        MEMBRANE,
        partial(scene_points, "tyre-solid", "14x18", _TYRE, "inflation", "inflated_equator_outer_mm"),
    ),
    Specimen(
        "isotropic tyre, pressed",
        _FORCE,
        MEMBRANE,
        partial(scene_points, "tyre-solid", "14x18", _TYRE, "press", "force_N"),
    ),
    Specimen("strip, h/L = 0.01, bent", "deflection", BENDING, partial(strip, 0.1)),
    Specimen("strip, h/L = 0.1, bent", "deflection", BENDING, partial(strip, 1.0)),
    Specimen(
        "ring, h/R = 0.08, crushed",
        _FORCE,
        BENDING,
        partial(scene_points, "crushed-ring-solid", "1x32", _THIN, "load", "force_N"),
    ),
    Specimen(
        "ring, h/R = 0.42, crushed",
        _FORCE,
        BENDING,
        partial(scene_points, "crushed-ring-solid", "1x24", _THICK, "load", "force_N"),
    ),
)
