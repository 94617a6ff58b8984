"""Section "Shell against solid": the difference of the two isotropic tyres, split into mesh parts and a model part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports import labels
from reports.markdown import Part, commands, digits, fixed, percent, prose, table
from reports.orders import FORMAL, fitted_order
from reports.tables import Cell, Store

SOLID = "isotropic_tyre_3d_solid.csv"
SOLID_COLUMNS = ("delta_mm", "force_N_ngsolve")
FACES = ("inner", "outer")


@dataclass(frozen=True)
class Sequence3:
    """A quantity on three meshes, coarse to fine, and the sizes of their elements in any unit."""

    sizes: tuple[float, ...]
    values: tuple[float, ...]

    @property
    def limit(self) -> float:
        """Extrapolated from the two finer meshes with the order 2."""
        return self._limit(1)

    @property
    def spread(self) -> float:
        """How far the limit has moved since it was extrapolated from the two coarser meshes, as a fraction."""
        return abs(self.limit - self._limit(0)) / abs(self.limit)

    @property
    def order(self) -> float | None:
        """The order that the three values show; None when they are not monotone."""
        return fitted_order(self.sizes, self.values)

    @property
    def mesh(self) -> float:
        """Finest value over limit, less one."""
        return self.values[-1] / self.limit - 1.0

    def _limit(self, first: int) -> float:
        coarse, fine = self.values[first : first + 2]
        return fine + (fine - coarse) / ((self.sizes[first] / self.sizes[first + 1]) ** FORMAL - 1.0)


def solid_part(store: Store) -> Part:
    """The whole section."""
    solids = [store.cell(labels.SOLID.format(mesh=mesh)) for mesh in labels.SOLID_MESHES]
    shells = [store.cell(label) for label in (labels.ISOTROPIC_COARSE, labels.ISOTROPIC, labels.ISOTROPIC_FINE)]
    reference = store.reference_table(SOLID, SOLID_COLUMNS)
    forces: Rows = {}
    for delta, force in zip(reference["delta_mm"], reference["force_N_ngsolve"], strict=True):
        values = ([cell.value("force_N", delta_mm=delta) for cell in cells] for cells in (solids, shells))
        solid, shell = map(_sequence, (solids, shells), values)
        forces[f"{delta:g}"] = (solid, shell, float(force))
    growth: Rows = {}
    for face in FACES:
        name = f"inflated_equator_{face}_mm"
        computed = float(store.references_of("tyre-solid", name, "computed")[0]["value"])
        values = ([cell.result["quantities"].get(name, math.nan) for cell in cells] for cells in (solids, shells))
        solid, shell = map(_sequence, (solids, shells), values)
        growth[face] = (solid, shell, computed)
    meshes = [cell.result["mesh"] for cell in (*solids, *shells)]
    blocks = [
        _introduction(solids, shells),
        _values("Force [N] on three meshes", "Δ [mm]", meshes, forces, 2),
        _parts("What the difference of the forces is made of", "Δ [mm]", forces),
        _penalty(store, solids),
        _equator(solids[-1], growth),
        _values("Growth of the equator by inflation [mm] on three meshes", "face", meshes, growth, 4),
        _parts("What the difference of the growth is made of", "face", growth),
        commands(cell.command for cell in (*solids, store.cell(labels.SOLID_PENALTY), *shells)),
    ]
    return Part("\n\n".join(blocks))


Rows = dict[str, tuple[Sequence3, Sequence3, float]]  # solid, shell, NGSolve


def _sequence(cells: Sequence[Cell], values: Sequence[float]) -> Sequence3:
    sizes = tuple(1.0 / float(cell.result["mesh"].split("x")[0]) for cell in cells)
    return Sequence3(sizes, tuple(float(value) for value in values))


def _introduction(solids: Sequence[Cell], shells: Sequence[Cell]) -> str:
    s, options = (cells[-1].result["settings"] for cells in (solids, shells))
    return prose(f"""## Shell against solid

The same isotropic tyre (E = {s["E_MPa"]:g} MPa, ν = {s["nu"]:g}, one layer of {s["ply_thickness_mm"]:g} mm, pressure
{s["p0_MPa"]:g} MPa that follows the inner face) as a shell (thickness strain {options["thickness_strain"]}, membrane
{options["membrane"]}) and as a solid of quadratic hexahedra, under the same plane
by the same contact algorithm. On no two meshes do they differ by the model alone, so each body is extrapolated first.
The difference of the finest shell ({shells[-1].result["mesh"]}) from the solid is then the sum of the shell's mesh part
and the model part, what one director and the constant S33 of the shell are worth.

A patch grows by whole nodes, so its force converges irregularly: the order that three meshes show scatters, or does not
exist (a dash). The limits below are extrapolated from the two finer meshes with the order {FORMAL:g}; "known
to" adds up how far the limits of both bodies have moved since the two coarser meshes. A model part smaller than that
is not told from zero. Pressures at single nodes are not compared: those of quadratic faces scatter from corners to
midpoints.""")


def _values(title: str, first: str, meshes: Sequence[str], rows: Rows, decimals: int) -> str:
    bodies = ("solid", "shell")
    header = [first]
    for body, names in zip(bodies, (meshes[:3], meshes[3:]), strict=True):
        header += [*(f"{body} {name}" for name in names), "limit", "order"]
    lines = []
    for name, (solid, shell, other) in rows.items():
        line = [name]
        for sequence in (solid, shell):
            line += [fixed(value, decimals) for value in (*sequence.values, sequence.limit)]
            line.append(fixed(sequence.order, 1))
        lines.append([*line, fixed(other, decimals)])
    return table(title, [*header, "NGSolve"], lines)


def _parts(title: str, first: str, rows: Rows) -> str:
    header = [first, "mesh part of the solid", "mesh part of the shell", "model part", "known to"]
    lines = []
    for name, (solid, shell, other) in rows.items():
        model = shell.limit / solid.limit - 1.0
        known = percent(solid.spread + shell.spread, sign=False)
        others = [percent(sequence.limit / other - 1.0) for sequence in (solid, shell)]
        lines.append([name, percent(solid.mesh), percent(shell.mesh), percent(model), known, *others])
    return table(title, [*header, "solid's limit - NGSolve", "shell's limit - NGSolve"], lines)


def _penalty(store: Store, solids: Sequence[Cell]) -> str:
    soft = store.cell(labels.SOLID_PENALTY)
    hard = next(cell for cell in solids if cell.result["mesh"] == soft.result["mesh"])
    changes = [step["force_N"] / hard.value("force_N", delta_mm=step["delta_mm"]) - 1.0 for step in soft.steps]
    steps = zip(soft.steps, changes, strict=True)
    each = ", ".join(f"{percent(change)} at {step['delta_mm']:g} mm" for step, change in steps)
    return prose(f"""NGSolve holds the plane by a penalty of {soft.result["settings"]["epsilon"]:g} MPa/mm. The same
penalty changes the force of our solid ({soft.result["mesh"]}) by {each}; that much of the difference between the two
solids is the penalty's.""")


def _equator(cell: Cell, growth: Rows) -> str:
    parts = " and ".join(
        f"{percent(shell.limit / solid.limit - 1.0)} ({face})" for face, (solid, shell, _) in growth.items()
    )
    s = cell.result["settings"]
    return prose(f"""### The inflated equator

Nothing touches yet, but the difference is larger: {parts}. The radius grows by the hoop strain
(N_φ - ν N_ψ)/(E h), and on a torus the two terms nearly cancel: by membrane theory N_φ alone is
{digits(cancellation(s), 2)} times their difference, so that what the shell neglects appears enlarged. It falls with
the square of the thickness, and with ν. Both bodies are held over the whole edge, where the solution is not smooth:
hence the low orders.""")


def cancellation(settings: dict[str, float]) -> float:
    """N_φ/(N_φ - ν N_ψ) at the outer equator of a torus under pressure, by membrane theory of its mid-surface.

    With the tube's radius R and its centre at Rc: N_φ = p R/2, N_ψ = p R (2 Rc + R)/(2 (Rc + R)).
    """
    R = settings["R1_mm"] + 0.5 * settings["plies"] * settings["ply_thickness_mm"]
    Rc = settings["R0_mm"] - settings["R1_mm"]
    hoop, meridian = 0.5, (2 * Rc + R) / (2 * (Rc + R))
    difference = hoop - settings["nu"] * meridian
    return hoop / difference if difference != 0 else math.inf
