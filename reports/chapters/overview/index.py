"""The first page: what is compared, how much of it is there, what was found, and what the numbers do not cover."""

from __future__ import annotations

import math
from collections.abc import Iterator

from reports.chapter import INDEX_TITLE
from reports.chapters.overview.headlines import headlines
from reports.chapters.overview.outcomes import completeness, refusals
from reports.chapters.shells.benchmarks import BENCHMARKS
from reports.chapters.shells.convergence import comparisons, sequences
from reports.chapters.shells.locking import worst_energy
from reports.chapters.shells.newton_steps import load_steps
from reports.chapters.tyre.algorithms import yardstick
from reports.chapters.tyre.cells import ALGORITHMS, BASE, DELTA, FINE, FOLLOWER, SLOWEST, change, nodes_unlike
from reports.chapters.tyre.meshes import beside_solids
from reports.chapters.tyre.paper import forces
from reports.chapters.tyre.printed_pressures import reading
from reports.formats import fixed, percent, scientific, share
from reports.markdown import Part, commands, folded, joined, machine, prose, table
from reports.origin import origin
from reports.store.cells import Cell
from reports.store.tables import Store


def index_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages."""
    sections = (_findings, _limitations, _completeness, origin)
    return joined(f"# {INDEX_TITLE}", headlines(store), "## Pages", contents, *(section(store) for section in sections))


def _completeness(store: Store) -> Part:
    cells = store.cells
    rows = [
        [scene, *_counts([c for c in cells if c.scene == scene])] for scene in dict.fromkeys(c.scene for c in cells)
    ]
    header = ["scene", "cells planned", "converged, steps as asked", "converged, steps cut", "refused", "not converged"]
    asked = [cell for cell in cells if not cell.unsupported]  # what an algorithm refuses stands on its own page
    unusual = [cell for cell in asked if cell.cuts or not cell.converged or cell.expected]
    return joined(
        "## Completeness",
        completeness(store),
        table("Cells behind the pages", header, [*rows, ["all", *_counts(cells)]]),
        *(_unusual(unusual) if unusual else ()),
        folded("Why cells were refused", refusals(store)),
    )


def _counts(cells: list[Cell]) -> list[int]:
    converged = [cell for cell in cells if cell.converged]
    cut, refused = sum(bool(cell.cuts) for cell in converged), sum(cell.unsupported for cell in cells)
    return [len(cells), len(converged) - cut, cut, refused, len(cells) - len(converged) - refused]


def _unusual(cells: list[Cell]) -> Iterator[str]:
    """What became of cells that did not go as asked, and how it ended."""
    header = ["cell", "what happened", "expected"]
    rows = [(cell.label, _happened(cell), cell.expected or "converges as asked") for cell in cells]
    yield table("Cells that did not go as asked, or were not expected to", header, rows, words=3)
    events = [[cell.label, event] for cell in cells for event in cell.cuts]
    events += [[cell.label, cell.reason] for cell in cells if not cell.converged]
    if events:
        yield machine(table("Rejected steps, and how it ended", ["cell", "event"], events, words=2))
    yield commands(cell.command for cell in cells)


def _happened(cell: Cell) -> str:
    if not cell.converged:
        return f"not converged: {cell.result['outcome']}"
    return "converged after its step was cut" if cell.cuts else "converged as asked"


def _findings(store: Store) -> str:
    found = (_linear(store), _newton(store), _agreement(store), _convergence(store), _element(store))
    return "\n".join(["## More findings", "", *(f"{i}. {text}" for i, text in enumerate(found, start=1))])


def _linear(store: Store) -> str:
    pairs = forces(store)
    (first, (low, high)), (linear, exact) = next(iter(pairs.items())), pairs[DELTA]
    return (
        f"**Linear against geometrically exact strains.** At a travel of {DELTA:g} mm linear "
        f"strains give {fixed(linear, 1)} N, exact ones {fixed(exact, 1)} N: the force is {fixed(linear / exact, 2)} "
        f"times as large. At {first:g} mm it is {fixed(low / high, 2)} times as large."
    )


def _newton(store: Store) -> str:
    mixed, _, plain = load_steps(store)
    fast, slow = store.find(**BASE), store.find(**SLOWEST)
    counts = [cell.result["counters"]["newton_iterations"] for cell in (mixed, plain, fast, slow)]
    return (
        f"**Mixed against plain Newton.** The hemisphere takes {counts[0]} iterations in one "
        f"step, plain Newton {counts[1]} in {plain.settings['steps']} steps; the tyre takes {counts[2]} with "
        f"`{fast.result['contact']}`, against {counts[3]} with `{slow.result['contact']}` and plain Newton."
    )


def _element(store: Store) -> str:
    found = store.analysis("element_choice")
    counts = [int((found["verdict"] == word).sum()) for word in ("better", "equal", "worse")]
    return prose(f"""**Which element.** On the coarsest mesh of each scene the default element is nearer to the limit
than the element of the paper for {counts[0]} of {len(found)} quantities, equal for {counts[1]} and worse for
{counts[2]}; see [which element](convergence.md#which-element).""")


def _agreement(store: Store) -> str:
    pairs = [(c, yardstick(store, c)) for c in store.select(**ALGORITHMS, epsilon=math.inf)]
    pairs = [(cell, reference) for cell, reference in pairs if cell is not reference]
    same = sum(nodes_unlike(*pair) == 0 for pair in pairs)
    offs = [abs(off) for off in (change(*pair) for pair in pairs) if not math.isnan(off)]
    return (
        f"**Algorithms against one another.** {same} of {len(pairs)} other ways to enforce the contact condition "
        f"exactly end on the very contact set of `semismooth` with mixed Newton; forces differ by at most "
        f"{scientific(max(offs, default=None))} of their value."
    )


def _convergence(store: Store) -> str:
    data = sequences(store)
    each, parts = data.drop_duplicates("sequence"), comparisons(store, data)
    parts = parts[parts["asymptotic"].astype(bool)]
    good = int(each["asymptotic"].sum())
    within = int(parts["verdict"].str.startswith("within").sum())
    return (
        f"**Mesh against model.** {good} of {len(each)} sequences of meshes are in their asymptotic range. Their "
        f"extrapolated values are within the uncertainties in {within} of {len(parts)} comparisons with references."
    )


def _limitations(store: Store) -> str:
    c = reading(store.analysis("tyre_comparison"), DELTA)
    mesh = change(store.find(**FINE), store.find(**BASE))
    follower = change(store.find(**FOLLOWER), store.find(**BASE))
    coarse, fine = (beside_solids(store)[f"{mesh}_off"].abs().max() for mesh in ("coarse", "fine"))
    hemisphere = BENCHMARKS[-1]
    quantity = list(hemisphere.quantities)[-1]
    errors = hemisphere.errors(store, "read")
    off = float(errors.loc[(errors["quantity"] == quantity) & (errors["load"] == 1.0), "model_part"].iloc[0])
    return prose(f"""## Known limitations

- The origin of the plane's travel in the paper is not known. Counted from first touch, at {DELTA:g} mm the
  centre pressure is {fixed(c["centre_MPa"], 3)} MPa (printed: {fixed(c["printed_centre_MPa"], 3)}), but {c["outside"]}
  of the {c["printed_nodes"]} printed nodes are not in contact.
- The paper's mesh is coarse: halving its elements changes the force by {percent(mesh)}. Its dead load is a model; a
  pressure that follows the wall changes the force by {percent(follower)}.
- Against three-dimensional solids the force of the isotropic tyre is off by up to {share(coarse)} on
  the mesh of the paper and by up to {share(fine)} on the finer one.
- The extrapolated {hemisphere.quantities[quantity].partition(" [")[0]} of the hemisphere is {percent(off)} from the
  published value.
- {_locking(store)}
- These pages cover one shell element in static equilibrium, and a rigid, frictionless plane as the only obstacle. Times
  are single runs.""")


def _locking(store: Store) -> str:
    shell, thinness, n, ratio = worst_energy(store)
    return (
        f"Coarse meshes of very thin doubly curved shells that bend freely [still lock](locking.md): of the energy of "
        f"the {shell} with free ends at h/R = {thinness:g}, {n} x {n} elements find {share(ratio, 0)}."
    )
