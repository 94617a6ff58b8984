"""The page of the benchmarks without contact: three meshes against published and exact values, and Newton's steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.shells import figures_benchmarks
from reports.chapters.shells.newton_steps import newton_part
from reports.markdown import Part, commands, fixed, joined, percent, picture, prose, table
from reports.tables import Store

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
    quantities: Mapping[str, str]
    references: Mapping[str, str]
    curve: str
    side: str
    remark: str

    def sequences(self, store: Store) -> pd.DataFrame:
        """Its sequences, a row a mesh, quantity by quantity, at growing loads."""
        data = store.analysis("convergence")
        own = data[(data["family"] == "benchmarks") & (data["ladder"] == self.scene)]
        return own.assign(load=own["at"].str.partition("=")[2].astype(float))

    def errors(self, store: Store, kind: str) -> pd.DataFrame:
        """Errors against one kind of reference, a row a mesh, with the loads and limits of the sequences."""
        errors = store.analysis("convergence_errors")
        named = self.sequences(store).drop_duplicates("sequence")[["sequence", "quantity", "load"]]
        return named.merge(errors[errors["kind"] == kind], on="sequence")


BENCHMARKS = (
    Benchmark(
        scene="cantilever",
        title="Cantilever under end shear",
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


def _values(store: Store, benchmark: Benchmark) -> Part:
    data = benchmark.sequences(store)
    references = {kind: benchmark.errors(store, kind) for kind in benchmark.references}
    values, sources = [], {}
    for sequence, own in data.groupby("sequence", sort=False):
        first = own.iloc[0]
        row = [benchmark.quantities[first["quantity"]], f"{first['load']:g}"]
        row += [fixed(value, 5) for value in (*own["value"], first["limit"])]
        for kind, name in benchmark.references.items():
            reference = references[kind][references[kind]["sequence"] == sequence].iloc[0]
            row.append(f"{reference['value']:.10g}")
            sources[name] = f"- *{name}*: {reference['source']}; relative uncertainty {reference['uncertainty']:g}"
        values.append(row)
    header = ["quantity", "load fraction", *dict.fromkeys(data["mesh"]), "extrapolated", *benchmark.references.values()]
    text = "\n\n".join(
        [
            f"## {benchmark.title}",
            f"References, in millimetres:\n\n{chr(10).join(sources.values())}",
            benchmark.remark,
            table(f"{benchmark.title}: displacements on three meshes", header, values),
            *(_orders(store, benchmark, kind) for kind in benchmark.references),
            commands(data["command"]),
        ]
    )
    return Part(text)


def _orders(store: Store, benchmark: Benchmark, kind: str) -> str:
    """Errors and orders against one reference."""
    own_order = benchmark.sequences(store).groupby("sequence")["order"].last()
    rows, meshes = [], []
    for sequence, own in benchmark.errors(store, kind).groupby("sequence", sort=False):
        first, meshes = own.iloc[0], list(own["mesh"])
        row = [benchmark.quantities[first["quantity"]], f"{first['load']:g}"]
        row += [percent(error, 3) for error in (*own["error"], first["model_part"])]
        rows.append([*row, *(fixed(order, 2) for order in (*own["order"].iloc[1:], own_order[sequence]))])
    steps = [f"order {a} to {b}" for a, b in pairwise(meshes)]
    header = ["quantity", "load fraction", *meshes, "extrapolated", *steps, "own order"]
    return table(f"{benchmark.title}: differences from {benchmark.references[kind]}, and orders", header, rows)


def _pictures(store: Store, benchmark: Benchmark) -> Part:
    data, columns = benchmark.sequences(store), list(benchmark.quantities)
    published = store.reference_table(benchmark.curve)
    published.columns = pd.Index(["load_fraction", *columns])
    meshes = list(dict.fromkeys(data["mesh"]))
    solved = data.dropna(subset="value")
    curves = {
        str(mesh): own.pivot(index="load", columns="quantity", values="value")
        .rename_axis("load_fraction")
        .reset_index()
        for mesh, own in solved.groupby("mesh", sort=False)
    }
    kind, who = next(iter(benchmark.references.items()))
    errors: dict[str, list[float]] = {}
    known, whole = benchmark.errors(store, kind), data[data["load"] == 1.0]
    for quantity in columns:
        name = benchmark.quantities[quantity].partition(" [")[0]
        against = known[(known["quantity"] == quantity) & (known["load"] == 1.0)]
        own = whole[whole["quantity"] == quantity]
        errors[f"{name}, from {who}"] = list(against["error"])
        if own["limit"].notna().all():
            errors[f"{name}, from the extrapolated value"] = list(own["value"] / own["limit"] - 1)
    names = f"{benchmark.scene}-load-displacement.svg", f"{benchmark.scene}-error.svg"
    text = "\n\n".join(
        [
            picture(names[0], f"{benchmark.title}: load fraction over displacements"),
            picture(names[1], f"{benchmark.title}: error over the mesh at full load"),
        ]
    )
    along = [int(mesh.split("x")[0]) for mesh in meshes]
    drawn = {
        names[0]: figures_benchmarks.load_displacement(curves, benchmark.quantities, published),
        names[1]: figures_benchmarks.error_by_mesh(along, errors, benchmark.side),
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
    needs=("convergence", "convergence_errors"),
    always=True,
)
