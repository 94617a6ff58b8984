"""Two faces that meet: pairings and masters beside known values, the six algorithms, and what an iteration costs.

Every problem is solved by both pairings with either body as slave, on meshes that do not match; what the answers differ
by is the bias of the pairing. References are closed forms, or the same body on a rigid plane.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from contact.catalogue import ALGORITHMS, is_exact
from contact.faces.sampling import PAIRINGS
from studies.ask.settings import configured
from studies.experiments import Row, tabulated
from studies.scenes.closed_forms.contact import flattened_ring, pressed_cylinders
from studies.scenes.complete import Cell, complete
from studies.scenes.contact.ring import RADIUS
from studies.scenes.data import reference_rows
from studies.scenes.faces import crossed_tubes, half_spheres, two_cylinders
from studies.scenes.faces.model import SHAPES, SLAVES
from studies.scenes.tyre.scene import ISOTROPIC
from studies.scenes.walk import walk
from studies.solving.friction_stages import Stages
from studies.solving.result import Result
from studies.solving.solve import solve

DELTA = 50.0  # mm, of rings
RUB = 0.5  # Coulomb's coefficient of half-spheres
TRAVEL = 0.025  # mm, of solid cylinders: the contact is 0.0095 of the radius wide


@dataclass(frozen=True)
class Problem:
    """A scene of two faces with what is read of it.

    meshes: coarse to fine.  exact: value by quantity; None where it is the same body on a plane, by ``beside`` on the
    last of the meshes doubled.  known: relative, to which the model of the reference is that of the scene.
    slaves: of one with itself there is no other.  options: beside the mesh.
    """

    scene: str
    settings: Mapping[str, str]
    meshes: tuple[str, ...]
    exact: Mapping[str, float]
    known: float
    slaves: tuple[str, ...] = SLAVES
    beside: Mapping[str, str] = field(default_factory=dict)
    options: Mapping[str, str] = field(default_factory=dict)


def _rings() -> dict[str, float]:
    return {"P_R2_over_EI": flattened_ring(1 - DELTA / RADIUS)[0]}


def _cylinders(ratio: float) -> dict[str, float]:
    moduli = tuple(each * two_cylinders.E / (1 - two_cylinders.NU**2) for each in (1.0, ratio))
    force = pressed_cylinders(2 * TRAVEL, two_cylinders.RADIUS, (moduli[0], moduli[1]))[0]
    over = force / two_cylinders.E / two_cylinders.RADIUS
    return {"P_over_ER": over, "peak_over_hertz": 1.0, "half_width_over_hertz": 1.0}


def _tyre(delta: float) -> dict[str, float]:
    """The isotropic tyre on a rigid plane, by an independent program with solids."""
    rows = reference_rows("isotropic_tyre_3d_solid.csv")
    return {"force_N": next(row["force_N_ngsolve"] for row in rows if row["delta_mm"] == delta)}


TYRE_MESHES = ("14x14", "28x28", "56x56")
RING_MESHES, SOLID_MESHES, PATCH_MESHES = ("1x20", "1x40", "1x80"), ("1x8", "1x16", "1x32"), ("2x2", "4x4", "8x8")
PROBLEMS: dict[str, Problem] = {
    "two rings": Problem("two-rings", {"delta_mm": "50"}, RING_MESHES, _rings(), 3e-4),
    "three rings": Problem("stack", {"delta_mm": "50"}, ("1x10", "1x20", "1x40"), _rings(), 3e-4, SLAVES[:1]),
    "ring on itself": Problem(
        "pinched-ring",
        {"F_R2_over_EI": "8"},
        ("1x24", "1x48", "1x96"),
        {"contact_R2_over_EI": np.nan},
        0.0,
        SLAVES[:1],
        {"against": "plane"},
    ),
    "solid cylinders, E alike": Problem("two-cylinders", {"delta_mm": f"{TRAVEL}"}, SOLID_MESHES, _cylinders(1), 1e-2),
    "solid cylinders, the second 10 times stiffer": Problem(
        "two-cylinders", {"delta_mm": f"{TRAVEL}", "E_ratio": "10"}, SOLID_MESHES, _cylinders(10), 1e-2
    ),
    "crossed tubes, at a point": Problem(
        "crossed-tubes",
        {"delta_mm": f"{crossed_tubes.POINT}", "shear_correction": "1000"},
        ("8x12", "16x24", "32x48"),
        {"dent_Eh_over_F": crossed_tubes.of_a_point("two")},
        1e-3,
        options={"measure": "linear"},
    ),
    "tyre on a stiff plate": Problem(
        "tyre-on-plate", {**ISOTROPIC, "E_plate_MPa": "1e8", "delta_mm": "20"}, TYRE_MESHES, _tyre(20.0), 3e-3
    ),
    "patch test, flat": Problem("face-patch", {}, PATCH_MESHES, {"pressure_error": 0.0}, 0.0),
    "patch test, curved, on facets": Problem(
        "face-patch", {"shape": "curved"}, PATCH_MESHES, {"pressure_error": 0.0}, 0.0
    ),
    "patch test, curved, faces curved": Problem(
        "face-patch", {"shape": "curved", "faces": "curved"}, PATCH_MESHES, {"pressure_error": 0.0}, 0.0
    ),
}


def faces_table() -> pd.DataFrame:
    """A row a problem, mesh, pairing, slave and quantity: its value and its error, relative unless the reference is 0.

    finest: whether no mesh of the problem is finer.  bias: by how much the errors of both slaves differ.
    """
    table = pd.DataFrame(list(_read()))
    errors = table.groupby(["problem", "mesh", "pairing", "quantity"], sort=False)["error"]
    return table.assign(bias=(errors.transform("max") - errors.transform("min")).where(errors.transform("count") > 1))


def _read() -> Iterator[Row]:
    for name, problem in PROBLEMS.items():
        exact = _beside(problem) if problem.beside else problem.exact
        for mesh, pairing, slave in product(problem.meshes, PAIRINGS, problem.slaves):
            chosen = {"pairing": pairing} | ({"slave": slave} if len(problem.slaves) > 1 else {})
            options = {"mesh": mesh, **problem.options}
            command, result = _solved(Cell("", problem.scene, options, {**problem.settings, **chosen}))
            shared = {"problem": name, "scene": problem.scene, "mesh": mesh, "pairing": pairing, "slave": slave}
            ended = {"outcome": result.verdict, "reason": result.reason, "command": command}
            spent = {"iterations": result.counters.get("newton_iterations", 0), "unknowns": result.counters["dofs"]}
            for quantity, reference in exact.items():
                value = result.quantities.get(quantity, np.nan)
                reading = {"quantity": quantity, "value": value, "reference": reference}
                reading["error"] = value / reference - 1 if reference else value
                known = {"known": problem.known, "finest": mesh == problem.meshes[-1]}
                yield {**shared, **reading, **known, **spent, "cpu_s": result.timing["cpu"], **ended}


def _beside(problem: Problem) -> dict[str, float]:
    """What the same body on a plane has, on a mesh twice as fine as the finest."""
    finest = "x".join(str(2 * int(n)) if int(n) > 1 else n for n in problem.meshes[-1].split("x"))
    _, plain = _solved(Cell("", problem.scene, {"mesh": finest}, {**problem.settings, **problem.beside}))
    return {key: plain.quantities[key] for key in problem.exact}


def _solved(cell: Cell) -> tuple[str, Result]:
    return cell.command, solve(*cell.resolved())


TOLERANCE = "1e-10"  # of the residual
CASES: dict[str, tuple[str, str, Mapping[str, str]]] = {
    "two rings": ("two-rings", "1x16", {"delta_mm": "10,50"}),
    "ring on itself": ("pinched-ring", "1x24", {"F_R2_over_EI": "6,8"}),
    "three rings": ("stack", "1x16", {"delta_mm": "10,50"}),
    "half-spheres": ("half-spheres", "12x1", {"delta_mm": "0.5,1"}),
    "crossed tubes": ("crossed-tubes", "8x12", {"delta_mm": "1,4"}),
    "patch test, curved": ("face-patch", "4x4", {"shape": "curved"}),
    "solid cylinders": ("two-cylinders", "1x8", {"delta_mm": "0.01,0.025"}),
    "solid ring on a layer": ("ring-on-layer", "1x12", {}),
    "tyre on a plate": ("tyre-on-plate", "14x14", {"delta_mm": "5,10"}),
    "tyre on a coated drum": ("tyre-on-drum", "14x14", {"delta_mm": "5,10"}),
    "plate dragged, mu = 0.3": ("face-patch", "4x4", {"drag_mm": "0.05,1,-1", "mu": "0.3"}),
    "two rings, mu = 0.3": ("two-rings", "1x16", {"delta_mm": "10,50", "mu": "0.3"}),
}


@tabulated
def algorithms_table() -> Iterator[Row]:
    """A row a case and algorithm, beside semismooth's: largest difference of a candidate's force over the largest."""
    for case, (scene, mesh, settings) in CASES.items():
        first: Result | None = None
        for name in sorted(ALGORITHMS, key=lambda each: each != "semismooth"):
            given = {**settings, "tolerance": TOLERANCE} | ({"epsilon": "inf"} if is_exact(name) else {})
            command, result = _solved(Cell("", scene, {"mesh": mesh, "contact": name}, given))
            first = first or result
            yield {
                "case": case,
                "algorithm": name,
                "outcome": result.verdict,
                "reason": result.reason or result.unsupported,
                "loads": len(result.steps),
                "judged": sum(not step["failures"] for step in result.steps),
                "substeps": sum(step["substeps"] for step in result.steps),
                "force_error": _apart(result, first),
                "iterations": result.counters.get("newton_iterations", 0),
                "command": command,
            }


def _apart(one: Result, other: Result) -> float:
    """Largest difference of a pressure at the end over the largest there; NaN where one has no end."""
    if one.last is None or other.last is None or one.verdict != other.verdict:
        return np.nan
    return float(np.max(np.abs(one.last.pressure - other.last.pressure)) / np.max(other.last.pressure))


SPHERES = ("30x1", "40x1", "80x1")


@tabulated
def spheres_table() -> Iterator[Row]:
    """Half-spheres with mu = 0.5 on facets and on curved faces: forces [N] by travel, until a path ends.

    Of the reference: middle and half width of what the published codes leave open.
    """
    known = {each.at["delta_mm"]: each for each in half_spheres.band() if each.at["mu"] == RUB}
    for faces, mesh in product(SHAPES, SPHERES):
        given = {"mu": f"{RUB}", "faces": faces, "delta_mm": ",".join(f"{delta:g}" for delta in known)}
        command, result = _solved(Cell("", "half-spheres", {"mesh": mesh}, given))
        forces = {step["delta_mm"]: step["quarter_N"] for step in result.steps}
        for delta, reference in known.items():
            read = {"reference": reference.value, "known": reference.uncertainty}
            shared = {"faces": faces, "mesh": mesh, "delta_mm": delta, "quarter_N": forces.get(delta, np.nan), **read}
            spent = {"iterations": result.counters["newton_iterations"], "cpu_s": result.timing["cpu"]}
            yield {**shared, **spent, "outcome": result.verdict, "reason": result.reason, "command": command}


REPEATS = 3
COSTED: dict[str, tuple[str, ...]] = {"ring": ("1x80", "1x160"), "two-rings": ("1x40", "1x80")}  # of as many unknowns
KINDS: tuple[tuple[str, dict[str, str]], ...] = (("ring", {}), *(("two-rings", {"pairing": each}) for each in PAIRINGS))


@tabulated
def cost_table() -> Iterator[Row]:
    """CPU seconds an iteration of two rings, by pairing, over those of one ring of as many unknowns on a plane.

    The least of REPEATS, in turn, so that a machine that slows down slows all.  size: a row of each kind has the same.
    """
    for size in range(len(COSTED["ring"])):
        cells = [Cell("", scene, {"mesh": COSTED[scene][size]}, {"delta_mm": "50", **own}) for scene, own in KINDS]
        runs = [[_an_iteration(cell) for cell in cells] for _ in range(REPEATS)]
        least = np.min([[cpu for cpu, _ in run] for run in runs], axis=0)
        for (scene, own), (_, unknowns), cpu in zip(KINDS, runs[0], least, strict=True):
            pairing = own.get("pairing", "rigid plane")
            costs = {"size": size, "unknowns": unknowns, "cpu_s": cpu, "ratio": cpu / least[0]}
            yield {"scene": scene, "pairing": pairing, **costs}


def _an_iteration(cell: Cell) -> tuple[float, float]:
    _, result = _solved(cell)
    return result.timing["cpu"] / result.counters["newton_iterations"], result.counters["dofs"]


# slab, mesh, place of the press and stops of the slide [mm], load steps of a leg: shorter ones where elements are
FORCES = "V_N_mm", "H_N_mm"
LONGER, SHORTER = (4.1, (1.0, 1.2), 13), (4.5, (0.3, 0.6, 0.7), 16)
IRONED = (
    *(("solid", "1x60", LONGER), ("solid", "1x120", LONGER), ("shell", "1x120", LONGER)),
    ("solid", "1x240", SHORTER),
)


@tabulated
def ironing_table() -> Iterator[Row]:
    """Shallow ironing with mu = 0.3 by slab and mesh: forces [N/mm] at the end of the press and as means over a slide.

    The press is that of the benchmark; the slide is one whose last leg is where the benchmark is half way, for a steady
    one depends on nothing before it. A path that ends before has no means.
    """
    for slab, mesh, (start, stops, parts) in IRONED:
        shared = {"mu": 0.3, "lines": "way", "slab": slab}
        press = _ironed(mesh, {**shared, "slide_mm": "0.01"}, 20).loc[:1.0].iloc[-1]
        table = _ironed(mesh, {**shared, "start_mm": start, "slide_mm": stops}, parts)
        over = table.loc[1.0 + stops[-2] - 1e-9 :]
        way = over.index.to_numpy()
        V, H = (float(np.trapezoid(over[name], way) / np.ptp(way)) if len(way) > 1 else np.nan for name in FORCES)
        row = {"slab": slab, "mesh": mesh, "V_press": press["V_N_mm"], "H_press": press["H_N_mm"]}
        ripple = float(over["H_over_V"].max() - over["H_over_V"].min())
        yield {**row, "V": V, "H": H, "ratio": H / V, "ripple": ripple, "states": len(table)}


def _ironed(mesh: str, settings: Mapping[str, Any], parts: int) -> pd.DataFrame:
    """What is read of every state on the way, by ``way_mm``."""
    scene, request = complete("ironing", settings, mesh)
    model, algorithm = scene.build(request), configured(request.contact, request.settings)
    seen = [
        visited.stage.observe(visited.problem_at(at), state, at).step
        for visited in walk(Stages(model.stages(), request.settings), algorithm, parts)
        for at, state in visited.point.way[1:]
    ]
    return pd.DataFrame(seen).set_index("way_mm")
