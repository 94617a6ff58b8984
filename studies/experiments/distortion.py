"""Meshes of quadrilaterals that follow no coordinates: what moving the nodes costs, by measure, option and shell.

Each row is one solve. Nodes are moved as :mod:`formulations.geometry.grid` says; an amount of 0 is the same
element on the grid as it is, so that the difference is the distortion's alone.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.geometry.grid import DISTORTIONS
from formulations.strains.catalogue import MEASURES
from studies.experiments import Row, tabulated
from studies.scenes.complete import complete
from studies.scenes.element import ON_MESHES
from studies.solving.solve import solve

AMOUNTS = (0.06, 0.12, 0.24)  # from 0.25 on an element of a random mesh can be concave
MESHES = (16, 32, 64)
SURFACE = "torus"
DEFAULT = ON_MESHES["quads"]
OPTIONS = tuple(
    {**DEFAULT, "thickness_strain": strain, "membrane": membrane}
    for strain, membrane in product(THICKNESS_STRAINS, MEMBRANES)
)
SHELLS: Mapping[str, tuple[str, int, int]] = {  # what is read off, and the elements of the coarser mesh
    "scordelis-lo": ("edge_deflection_mm", 16, 16),
    "pinched-cylinder": ("deflection_mm", 16, 16),
    "hemisphere": ("outward_mm", 16, 16),
    "sze-annulus": ("w_B_mm", 6, 48),
    "cantilever": ("tip_deflection_mm", 16, 4),
    "raasch-hook": ("tip_deflection_mm", 56, 8),
    "hypar": ("tip_deflection_mm", 32, 16),
    "twisted-beam": ("tip_deflection_mm", 24, 4),
    "morley-skew-plate": ("w_bar", 16, 16),
}


def ways(amounts: Sequence[float]) -> Iterator[tuple[str, float]]:
    """How nodes are moved and how far: not at all, then each way by each amount."""
    yield "regular", 0.0
    yield from product(DISTORTIONS, amounts)


def moved(kind: str, amount: float) -> dict[str, str]:
    """The settings of a moved mesh."""
    return {"distortion": kind, "distort": f"{amount:g}"} if amount else {}


@tabulated
def distortion(measures: Sequence[str] = tuple(MEASURES), meshes: Sequence[int] = MESHES) -> Iterator[Row]:
    """Errors of manufactured solutions on a torus: a row a measure, distortion and mesh of n x n elements.

    error_*: as the scene of manufactured solutions reads them.
    """
    for measure, (kind, amount), n in product(measures, ways(AMOUNTS[1:]), meshes):
        settings = {"surface": SURFACE, "element": "quads", **moved(kind, amount)}
        result = solve(*complete("manufactured", settings, f"{n}x{n}", measure=measure))
        case = {"measure": measure, "distortion": kind, "amount": amount, "n": n}
        yield {**case, **result.quantities, "class": result.verdict}


@tabulated
def distorted_shells(shells: Sequence[str] = tuple(SHELLS)) -> Iterator[Row]:
    """Deflections of linear shells: the default element on two meshes, the second twice as fine, each option on one.

    change: value over that of the same element on the same mesh whose nodes stay, less 1.
    """
    cases: list[tuple[dict[str, str], int, Sequence[float]]] = [(DEFAULT, 1, AMOUNTS), (DEFAULT, 2, AMOUNTS)]
    cases += [(options, 1, AMOUNTS[1:2]) for options in OPTIONS if options != DEFAULT]
    for scene, (options, finer, amounts) in product(shells, cases):
        quantity, n1, n2 = SHELLS[scene]
        mesh, still = f"{n1 * finer}x{n2 * finer}", 0.0
        for kind, amount in ways(amounts):
            result = solve(*complete(scene, {**options, **moved(kind, amount)}, mesh, measure="linear"))
            value = float(result.quantities[quantity])
            still = still if amount else value
            case = {"scene": scene, "quantity": quantity, "mesh": mesh, "finer": finer, **options}
            seen = {"distortion": kind, "amount": amount, "value": value, "change": value / still - 1}
            yield {**case, **seen, "class": result.verdict}
