"""The page of the benchmarks without contact: three meshes against published and exact values, and Newton's steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.shells import figures_benchmarks
from reports.chapters.shells.newton_steps import newton_part
from reports.chapters.shells.programs import programs_part
from reports.formats import fixed, percent
from reports.markdown import Part, commands, joined, picture, prose, table
from reports.store.tables import Store

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
    return joined(INTRODUCTION, *parts, newton_part(store), _equilibrium(store), programs_part(store))


def _values(store: Store, benchmark: Benchmark) -> Part:
    data = benchmark.sequences(store)
    known = {
        name: benchmark.errors(store, kind).drop_duplicates("sequence").set_index("sequence")
        for kind, name in benchmark.references.items()
    }
    rows = []
    for sequence, own in data.groupby("sequence", sort=False):
        values = [fixed(value, 5) for value in (*own["value"], own["limit"].iloc[0])]
        published = (f"{each['value'][sequence]:.10g}" for each in known.values())
        rows.append([*_named(benchmark, own), *values, *published])
    sources = [
        f"- *{name}*: {each['source'].iloc[-1]}; relative uncertainty {each['uncertainty'].iloc[-1]:g}"
        for name, each in known.items()
    ]
    header = ["quantity", "load fraction", *dict.fromkeys(data["mesh"]), "extrapolated", *known]
    return joined(
        f"## {benchmark.title}",
        "\n".join(["References, in millimetres:", "", *sources]),
        benchmark.remark,
        table(f"{benchmark.title}: displacements on three meshes", header, rows),
        *(_orders(store, benchmark, kind) for kind in benchmark.references),
        commands(data["command"]),
    )


def _named(benchmark: Benchmark, sequence: pd.DataFrame) -> list[str]:
    """Quantity and load."""
    first = sequence.iloc[0]
    return [benchmark.quantities[first["quantity"]], f"{first['load']:g}"]


def _orders(store: Store, benchmark: Benchmark, kind: str) -> str:
    """Errors and orders against one reference."""
    own_order = benchmark.sequences(store).groupby("sequence")["order"].last()
    rows, meshes = [], []
    for sequence, own in benchmark.errors(store, kind).groupby("sequence", sort=False):
        meshes = list(own["mesh"])
        errors = [percent(error, 3) for error in (*own["error"], own["model_part"].iloc[0])]
        orders = [fixed(order, 2) for order in (*own["order"].iloc[1:], own_order[sequence])]
        rows.append([*_named(benchmark, own), *errors, *orders])
    steps = [f"order {a} to {b}" for a, b in pairwise(meshes)]
    header = ["quantity", "load fraction", *meshes, "extrapolated", *steps, "own order"]
    return table(f"{benchmark.title}: differences from {benchmark.references[kind]}, and orders", header, rows)


def _pictures(store: Store, benchmark: Benchmark) -> Part:
    data, columns = benchmark.sequences(store), list(benchmark.quantities)
    published = store.reference_table(benchmark.curve)
    published.columns = pd.Index(["load_fraction", *columns])
    curves = {
        str(mesh): own.pivot(index="load", columns="quantity", values="value")
        .rename_axis("load_fraction")
        .reset_index()
        for mesh, own in data.dropna(subset="value").groupby("mesh", sort=False)
    }
    kind, who = next(iter(benchmark.references.items()))
    known, whole = (each[each["load"] == 1.0] for each in (benchmark.errors(store, kind), data))
    errors: dict[str, list[float]] = {}
    for quantity, own in whole.groupby("quantity", sort=False):
        name = benchmark.quantities[str(quantity)].partition(" [")[0]
        errors[f"{name}, from {who}"] = list(known[known["quantity"] == quantity]["error"])
        if own["limit"].notna().all():
            errors[f"{name}, from the extrapolated value"] = list(own["value"] / own["limit"] - 1)
    along = [int(mesh.split("x")[0]) for mesh in dict.fromkeys(data["mesh"])]
    path = figures_benchmarks.load_displacement(curves, benchmark.quantities, published)
    by_mesh = figures_benchmarks.error_by_mesh(along, errors, benchmark.side)
    name, title = benchmark.scene, benchmark.title
    return joined(
        picture(f"{name}-load-displacement.svg", f"{title}: load fraction over displacements", path),
        picture(f"{name}-error.svg", f"{title}: error over the mesh at full load", by_mesh),
    )


def _equilibrium(store: Store) -> str:
    """How many reported states, of this page and all others, the judge certifies."""
    cells = store.cells
    steps = [step for cell in cells for step in cell.steps]
    failed = [step for step in steps if step["failures"]]
    rounded = sum(step["kkt"]["equilibrium"] > EQUILIBRIUM for step in steps)
    text = prose(f"""## Certificates

The judge recomputes equilibrium, the contact conditions, and where it can the balances of energy and of all forces,
of each of the {len(steps)} states on all pages, and certifies {len(steps) - len(failed)} of them. A residual that
rounding explains is excused up to a bound, and beyond it only where it moves nothing: shells as thin as these reach
that before they reach {EQUILIBRIUM:g} of the forces in balance. So do {rounded} of the states.""")
    if failed:
        names = dict.fromkeys(name for step in failed for name in step["failures"])
        scenes = dict.fromkeys(cell.scene for cell in cells if any(step["failures"] for step in cell.steps))
        text += f" Not certified, for {', '.join(names)}: states of {', '.join(scenes)}."
    return text


CHAPTER = Chapter(
    "benchmarks",
    "Benchmarks without contact",
    "large bending against exact and published values.",
    benchmarks_page,
    needs=("convergence", "convergence_errors"),
    always=True,
)
