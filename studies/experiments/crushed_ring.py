"""The crushed ring by solids of every law and by shells, on sequences of meshes, and with its data as far off as known.

What the differences to the test are made of is worked out in :mod:`studies.analysis.uncertainty`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from studies.experiments.rows import Row, tabulated
from studies.run.campaigns.cell import Cell
from studies.scenes.complete import complete
from studies.scenes.contact.crushed_ring import DATA
from studies.solving.result import SOLVED
from studies.solving.solve import solve

SHELL, SOLID = "crushed-ring", "crushed-ring-solid"
NO_NU = {"nu": "0", "E_MPa": repr(DATA["E_MPa"] / (1 - DATA["nu"] ** 2))}  # the other way to plane strain
# Half of the last digit in which the data are given: 407 N/cm^2, 0.48, 6.35 and 4.15 cm
HALF_DIGIT = {"E_MPa": 0.005, "nu": 0.005, "outer_mm": 0.05, "inner_mm": 0.05}
AXIAL = ("plane-stress", "3d")
MESHES, INPUTS, STATES = "meshes", "inputs", "states"
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

    least_stretch, largest_stretch: of solids.  study: "meshes"; "inputs": one of the data off by its half digit
    ``change`` [in its unit], by the shell of the exact measure; "states": Hencky's solid in another state along the
    axis, named ``input``.  Raises RuntimeError where one does not converge.
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
    for state in AXIAL:
        across = 2 if state == "3d" else 1
        yield from _solved(hencky, hencky.cell(n, through, across, {"state": state}), STATES, n, state)


def _solved(body: Body, cell: Cell, study: str, n: int, key: str = "", change: float = np.nan) -> list[Row]:
    """A row a travel."""
    result = solve(*complete(cell.scene, cell.settings, **cell.options))
    if result.verdict not in SOLVED:
        raise RuntimeError(f"{cell.command}: {result.verdict}, {result.reason}")
    own = {"study": study, "body": body.name, "kind": body.kind, "of": body.of, "input": key, "change": change}
    own |= {"mesh": cell.options["mesh"], "size": 1 / n}
    read = ("delta_mm", "force_N", "least_stretch", "largest_stretch")
    told = {"command": cell.command}
    return [own | {name: step.get(name, np.nan) for name in read} | told for step in result.steps]
