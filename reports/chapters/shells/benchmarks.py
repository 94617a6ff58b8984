"""The page of the benchmarks without contact: three meshes against published and exact values, and Newton's steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import pandas as pd

from reports import labels
from reports.chapter import Chapter
from reports.chapters.shells import figures_benchmarks
from reports.chapters.shells.newton_steps import newton_part
from reports.markdown import Part, commands, fixed, joined, percent, picture, prose, table
from reports.orders import extrapolated, order_against, self_order
from reports.tables import Cell, Store

INTRODUCTION = prose("""# Benchmarks without contact

Two shells that bend through large rotations, each on three meshes, with the element of the paper (`element=paper`; the
default one is [better](convergence.md#which-element)). *Order* is the exponent p of an error that falls
like h^p: against a reference from the errors of two meshes, and *own* from the differences of all three, which needs
no reference. *Extrapolated* is Richardson's limit with the own order. A dash stands where an order has no meaning: the
error changes its sign, or is below the uncertainty of the reference.""")
EQUILIBRIUM = 1e-8  # relative residual that passes without a look at rounding


@dataclass(frozen=True)
class Benchmark:
    """A scene of this page; references: kind -> short name, the first is the one whose errors are drawn."""

    scene: str
    title: str
    label: str
    quantities: Mapping[str, str]
    references: Mapping[str, str]
    curve: str
    side: str
    remark: str

    def cells(self, store: Store) -> dict[int, Cell]:
        """The meshes by elements along a side."""
        return {n: store.cell(self.label.format(n=n)) for n in labels.MESHES}


BENCHMARKS = (
    Benchmark(
        scene="cantilever",
        title="Cantilever under end shear",
        label=labels.CANTILEVER,
        quantities={"tip_shortening_mm": "tip shortening [mm]", "tip_deflection_mm": "tip deflection [mm]"},
        references={"exact": "elastica", "read": "Sze et al."},
        curve="sze2004_3.1_cantilever_end_shear.csv",
        side="the length",
        remark="The elastica neither shears nor stretches. The shell does both and converges to values slightly above: "
        "the kink in its error against the elastica is a change of sign.",
    ),
    Benchmark(
        scene="hemisphere",
        title="Hemisphere with a hole under point loads",
        label=labels.HEMISPHERE,
        quantities={"outward_mm": "outward displacement [mm]", "inward_mm": "inward displacement [mm]"},
        references={"read": "Sze et al."},
        curve="sze2004_3.4_hemisphere_18deg_hole.csv",
        side="a quarter of the equator",
        remark="The published values come from one mesh of another element; they carry an error of their own.",
    ),
)


def benchmarks_page(store: Store) -> Part:
    """The whole page."""
    parts = [part for benchmark in BENCHMARKS for part in (_values(store, benchmark), _pictures(store, benchmark))]
    return joined([Part(INTRODUCTION), *parts, newton_part(store), Part(_equilibrium(store))])


def limit(store: Store, benchmark: Benchmark, quantity: str, fraction: float) -> float | None:
    """Richardson's limit of a quantity over the three meshes."""
    return extrapolated(*_on_meshes(store, benchmark, quantity, fraction))


def _on_meshes(store: Store, benchmark: Benchmark, quantity: str, fraction: float) -> tuple[float, float, float]:
    """A quantity on the three meshes, NaN where a path did not get there."""
    cells = benchmark.cells(store).values()
    coarse, medium, fine = (cell.value(quantity, load_fraction=fraction) for cell in cells)
    return coarse, medium, fine


def _places(store: Store, benchmark: Benchmark) -> list[tuple[str, float]]:
    """Quantities and the load fractions that were asked for."""
    coarsest = next(iter(benchmark.cells(store).values()))
    fractions = coarsest.result["settings"]["load_fraction"]
    return [(quantity, float(fraction)) for quantity in benchmark.quantities for fraction in fractions]


def _values(store: Store, benchmark: Benchmark) -> Part:
    cells = benchmark.cells(store)
    meshes = [cell.result["mesh"] for cell in cells.values()]
    values, sources = [], {}
    for quantity, fraction in _places(store, benchmark):
        row = [benchmark.quantities[quantity], f"{fraction:g}"]
        row += [fixed(value, 5) for value in _on_meshes(store, benchmark, quantity, fraction)]
        row.append(fixed(limit(store, benchmark, quantity, fraction), 5))
        for kind, name in benchmark.references.items():
            reference = store.reference(benchmark.scene, quantity, kind, load_fraction=fraction)
            row.append(f"{reference['value']:.10g}")
            sources[name] = f"- *{name}*: {reference['source']}; relative uncertainty {reference['uncertainty']:g}"
        values.append(row)
    header = ["quantity", "load fraction", *meshes, "extrapolated", *benchmark.references.values()]
    text = "\n\n".join(
        [
            f"## {benchmark.title}",
            f"References, in millimetres:\n\n{chr(10).join(sources.values())}",
            benchmark.remark,
            table(f"{benchmark.title}: displacements on three meshes", header, values),
            *(_orders(store, benchmark, kind) for kind in benchmark.references),
            commands(cell.command for cell in cells.values()),
        ]
    )
    return Part(text)


def _orders(store: Store, benchmark: Benchmark, kind: str) -> str:
    """Errors and orders against one reference."""
    meshes = [cell.result["mesh"] for cell in benchmark.cells(store).values()]
    rows = []
    for quantity, fraction in _places(store, benchmark):
        f = _on_meshes(store, benchmark, quantity, fraction)
        source = store.reference(benchmark.scene, quantity, kind, load_fraction=fraction)
        reference, noise = source["value"], source["value"] * source["uncertainty"]
        goal = extrapolated(*f)
        row = [benchmark.quantities[quantity], f"{fraction:g}", *(percent(value / reference - 1, 3) for value in f)]
        row.append(percent(None if goal is None else goal / reference - 1, 3))
        orders = [*(order_against(a, b, reference, noise) for a, b in pairwise(f)), self_order(*f)]
        rows.append([*row, *(fixed(order, 2) for order in orders)])
    steps = [f"order {a} to {b}" for a, b in pairwise(meshes)]
    header = ["quantity", "load fraction", *meshes, "extrapolated", *steps, "own order"]
    return table(f"{benchmark.title}: differences from {benchmark.references[kind]}, and orders", header, rows)


def _pictures(store: Store, benchmark: Benchmark) -> Part:
    cells, columns = benchmark.cells(store), list(benchmark.quantities)
    published = store.reference_table(benchmark.curve)
    published.columns = pd.Index(["load_fraction", *columns])
    curves = {cell.result["mesh"]: pd.DataFrame(cell.steps) for cell in cells.values() if cell.steps}
    kind, who = next(iter(benchmark.references.items()))
    errors: dict[str, list[float]] = {}
    for quantity in columns:
        f, goal = _on_meshes(store, benchmark, quantity, 1.0), limit(store, benchmark, quantity, 1.0)
        reference = store.reference(benchmark.scene, quantity, kind, load_fraction=1.0)["value"]
        name = benchmark.quantities[quantity].partition(" [")[0]
        errors[f"{name}, from {who}"] = [value / reference - 1 for value in f]
        if goal is not None:
            errors[f"{name}, from the extrapolated value"] = [value / goal - 1 for value in f]
    names = f"{benchmark.scene}-load-displacement.svg", f"{benchmark.scene}-error.svg"
    text = "\n\n".join(
        [
            picture(names[0], f"{benchmark.title}: load fraction over displacements"),
            picture(names[1], f"{benchmark.title}: error over the mesh at full load"),
        ]
    )
    drawn = {
        names[0]: figures_benchmarks.load_displacement(curves, benchmark.quantities, published),
        names[1]: figures_benchmarks.error_by_mesh(labels.MESHES, errors, benchmark.side),
    }
    return Part(text, drawn)


def _equilibrium(store: Store) -> str:
    """How many reported states, of this page and all others, the judge certifies."""
    cells = list(store.cells.values())
    steps = [step for cell in cells for step in cell.steps]
    failed = [step for step in steps if step["failures"]]
    text = prose(f"""## Certificates

The judge recomputes equilibrium, the contact conditions, and where it can the balances of energy and of all forces,
of each of the {len(steps)} states on all pages, and certifies {len(steps) - len(failed)} of them. A residual that
rounding explains is excused up to a bound, and beyond it only where it moves nothing: shells as thin as these reach
that before they reach {EQUILIBRIUM:g} of the forces in balance. So do {sum(map(_rounded, steps))} of the states.""")
    if failed:
        names = dict.fromkeys(name for step in failed for name in step["failures"])
        scenes = dict.fromkeys(cell.scene for cell in cells if any(step["failures"] for step in cell.steps))
        text += f" Not certified, for {', '.join(names)}: states of {', '.join(scenes)}."
    return text


def _rounded(step: Mapping[str, Any]) -> bool:
    """Is its equilibrium a matter of rounding?"""
    return bool(step["kkt"]["equilibrium"] > EQUILIBRIUM)


CHAPTER = Chapter(
    "benchmarks",
    "Benchmarks without contact",
    "large bending against exact and published values.",
    benchmarks_page,
    always=True,
)
