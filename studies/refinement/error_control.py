"""A quantity to an error: grids refined where it is decided, until its limit is known well enough.

Each round solves on a grid and on the one with all its elements cut, T and T'. Bilinear elements converge with the
square of their size, so that a round says of the limit::

    L = J' + (J' - J)/3

and two rounds with different grids say how well: L is within ::

    u = max(SAFETY |L - L_before|, |J' - J|/3, rim/2)

of the limit. The second term is all that Richardson's law adds: with nodes that hang on coarse elements T may be off by
more than four times what T' is. The third is half of what the rim of a patch of contact, which jumps from node to node,
has done from T to T'. A first round alone knows |J' - J|. Where u is too large, the difference between T and T' shows
which elements to cut (:mod:`studies.refinement.indicators`), and the next round begins.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contact.problem import Outcome
from studies.analysis.richardson import correction
from studies.complete import complete
from studies.refinement.goal import OnGrid, on_grid
from studies.refinement.indicators import indicators
from studies.refinement.trees import Family
from studies.request import Request
from studies.result import Result
from studies.scene import RefinedScene, Scene, ShellSceneModel, UsageError
from studies.scenes import SCENES
from studies.solving import solve
from studies.store.tables import Table

SAFETY = 1.5
MOST = 60_000  # unknowns of the next finer grid, at which a round is not begun
FEWEST, MOST_ROUNDS = 2, 8
COARSER = 4  # the default mesh over the coarsest one
TOO_COARSE = 2  # times that a coarsest grid which cannot carry the load is cut everywhere


@dataclass(frozen=True)
class Round:
    """A quantity on a grid and on the one with all elements cut, and their unknowns.

    seconds: CPU time of the round; finer_seconds, own_seconds: of the finer grid and of the other alone, which may be
    that of the round before.  rim: what the rim of a patch of contact adds to the indicators.
    """

    value: float
    finer: float
    unknowns: int
    finer_unknowns: int
    seconds: float
    finer_seconds: float
    rim: float = 0.0
    own_seconds: float = 0.0

    @property
    def limit(self) -> float:
        """Richardson's for the order 2."""
        return self.finer + correction((2.0, 1.0), (self.value, self.finer))


@dataclass(frozen=True)
class Estimate:
    """limit: within +-uncertainty; error: of the last grid's value, in [low, high]. All but the limit are relative."""

    limit: float
    uncertainty: float
    error: float

    @property
    def low(self) -> float:
        """The least that the error of the last grid's value may be."""
        return max(self.error - self.uncertainty, 0.0)

    @property
    def high(self) -> float:
        """The most that it may be."""
        return self.error + self.uncertainty


def parse_error(text: str) -> float:
    """The relative error of "1%" or "0.01"; raises UsageError unless it is in [0.01%, 50%]."""
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        value = float("nan")
    if not 1e-4 <= value <= 0.5:
        raise UsageError(f"error {text!r} must be a part of the quantity in [0.01%, 50%], as 1% or 0.01")
    return value


def estimate(rounds: Sequence[Round]) -> Estimate:
    """What all rounds so far say of the limit."""
    last = rounds[-1]
    step = abs(last.finer - last.value)
    within = step if len(rounds) == 1 else max(SAFETY * abs(last.limit - rounds[-2].limit), step / 3, last.rim / 2)
    scale = abs(last.limit) or np.finfo(float).tiny
    return Estimate(last.limit, within / scale, abs(last.finer - last.limit) / scale)


def coarsest(
    name: str, given: Mapping[str, object], mesh: str | Sequence[int] | None = None, **options: Any
) -> tuple[Scene, Request]:
    """The scene and its request on the grid from which a refinement sets out, as :func:`studies.complete.complete`.

    mesh: by default what the scene names, or a quarter of its own both ways. Where lines could be crowded where the
    scene expects what decides its answers, they are not: refinement finds that out.
    """
    scene = SCENES.get(name)
    if scene is not None:
        mesh = mesh or coarsest_mesh(scene)
        if any(setting.key == "grading" for setting in scene.settings):
            given = {"grading": "uniform", **given}
    return complete(name, given, mesh, **options)


def coarsest_mesh(scene: Scene) -> tuple[int, int]:
    """A quarter of the default mesh both ways, or what the scene names."""
    if isinstance(scene, RefinedScene):
        return scene.coarsest_mesh
    n1, n2 = (n if n == 1 else max(2, n // COARSER) for n in scene.default_mesh)
    return n1, n2


def solve_to_error(
    scene: Scene,
    request: Request,
    error: float,
    quantity: str | None = None,
    progress: Callable[[str], None] = lambda text: None,
    most: int = MOST,
) -> tuple[Result, bool]:
    """The result on the finest grid, and whether its quantity is surely known to a relative ``error``.

    request: on the coarsest mesh.  quantity: by default the force, or the first that the scene has references for. The
    quantities hold the estimate, the table ``refinement`` the rounds. A path that ends before its last load ends the
    refinement: its result is returned. Raises UsageError for a quantity that the scene does not have.
    """
    family, rounds = Family.of(scene, request), list[Round]()
    known, too_coarse = None, 0
    for _ in range(MOST_ROUNDS):
        start = time.process_time()
        coarse = known or solve(scene, family.asked, progress)
        if coarse.unsupported:
            return coarse, False
        if not coarse.outcome.converged:
            if rounds or too_coarse == TOO_COARSE or coarse.outcome is Outcome.WRONG:
                return coarse, False
            family, too_coarse = family.everywhere(), too_coarse + 1
            continue
        quantity = quantity or default_quantity(scene, coarse)
        if quantity not in coarse.quantities:
            raise UsageError(f"{scene.name} has no quantity {quantity!r}; it has {', '.join(coarse.quantities)}")
        finer = family.everywhere()
        fine = solve(scene, finer.asked, progress)
        if not fine.outcome.converged:
            return fine, False
        unknowns, most_unknowns = (int(each.counters["dofs"]) for each in (coarse, fine))
        value, finer_value = coarse.quantities[quantity], fine.quantities[quantity]
        following, rim = _next(family, finer, coarse, fine, quantity)
        seconds = time.process_time() - start, fine.timing["cpu"]
        rounds.append(Round(value, finer_value, unknowns, most_unknowns, *seconds, rim, coarse.timing["cpu"]))
        found = estimate(rounds)
        progress(f"{quantity} {found.limit:.6g} +- {100 * found.uncertainty:.2g} %")
        _record(fine, quantity, rounds, found, error)
        if len(rounds) >= FEWEST and found.uncertainty <= error:
            return fine, True
        if most_unknowns > most / 2 or following.asked == family.asked:  # too many, or all that is marked is deepest
            break
        family = following
        known = fine if family.asked == finer.asked else None
    fine.reason = f"no grid of up to {most} unknowns has a {quantity} that is surely within {100 * error:g} %"
    return fine, False


def default_quantity(scene: Scene, result: Result) -> str:
    """The force, the first quantity with a reference, or the first of all."""
    named = ["force_N", *(reference.quantity for reference in scene.references), *result.quantities]
    return next(name for name in named if name in result.quantities)


def _next(family: Family, finer: Family, coarse: Result, fine: Result, quantity: str) -> tuple[Family, float]:
    """The grid of the next round, refined where the quantity asks for it, and what the rim has of the indicators.

    Where there is no dual problem, it is refined everywhere.
    """
    if family.tree is None or finer.tree is None:
        return finer, 0.0
    try:
        on_both = _on_grid(coarse, quantity), _on_grid(fine, quantity)
    except (KeyError, ArithmeticError):
        return finer, 0.0
    eta, rim = indicators(*on_both, family.tree.parents(finer.tree))
    return family.refined(eta), rim


def _on_grid(result: Result, quantity: str) -> OnGrid:
    assert isinstance(result.model, ShellSceneModel)
    assert result.end is not None
    return on_grid(result.end, quantity, result.model.shell, result.model.candidate_of_node)


def _record(result: Result, quantity: str, rounds: Sequence[Round], found: Estimate, error: float) -> None:
    """The estimate as quantities, and the rounds as a table."""
    rows = [{"quantity": quantity, **vars(each), "limit": each.limit} for each in rounds]
    result.tables["refinement"] = [Table.of_rows(rows)]
    if isinstance(result.model, ShellSceneModel):
        result.tables["grid"] = [_elements(result.model, result.request)]
    result.quantities |= {
        "error_asked": error,
        f"extrapolated_{quantity}": found.limit,
        "uncertainty": found.uncertainty,
        "error_estimate": found.error,
        "error_low": found.low,
        "error_high": found.high,
    }


def _elements(model: ShellSceneModel, request: Request) -> Table:
    """The elements of the last grid: their ends along a1 and a2, and how often they were cut."""
    grid = model.shell.discretisation.grid
    low, high = grid.centre - grid.half, grid.centre + grid.half
    levels = [level for level, _, _ in request.leaves] or np.zeros(len(low), int)
    ends = {f"a{axis + 1}_{name}": each[:, axis] for axis in (0, 1) for name, each in (("low", low), ("high", high))}
    return Table.of({**ends, "level": levels})
