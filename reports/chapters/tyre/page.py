"""The page of the tyre: its sections in order."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.tyre.algorithms import algorithms_part, costs_part
from reports.chapters.tyre.cells import CURVES, PAPER
from reports.chapters.tyre.meshes import meshes_part
from reports.chapters.tyre.paper import paper_part
from reports.chapters.tyre.printed_pressures import printed_part
from reports.markdown import Part, joined
from reports.store.tables import Store

INTRODUCTION = """# The tyre

Angles: ψ runs along the meridian and is zero at the outer equator, φ runs around the axis and is zero where the plane
touches first. Pressures are contact pressures, positive in compression. The element is that of the paper throughout
(`element=paper`). `DIR` in a command is any new directory.

1. [The paper's tyre under a plane](#the-papers-tyre-under-a-plane)
2. [The printed table](#the-printed-table) and its [symmetry](#symmetry)
3. [Measures and algorithms](#measures-and-algorithms)
4. [From pressure to nodal force](#from-pressure-to-nodal-force)
5. [Mesh and load](#mesh-and-load)
6. [An isotropic tyre against three-dimensional solids](#an-isotropic-tyre-against-three-dimensional-solids)
7. [Costs](#costs)"""


def tyre_page(store: Store) -> Part:
    """The whole page."""
    for delta in CURVES:  # without these indentations there is no page
        store.find(**PAPER).step(delta_mm=delta)
    sections = (paper_part, printed_part, algorithms_part, meshes_part, costs_part)
    return joined(INTRODUCTION, *(section(store) for section in sections))


CHAPTER = Chapter(
    "tyre",
    "The tyre",
    "an inflated angle-ply torus pressed on a rigid plane, against the paper's printed table and against solids.",
    tyre_page,
    needs=("rules", "tyre_comparison", "tyre_printed_nodes", "tyre_symmetry"),
    always=True,
)
