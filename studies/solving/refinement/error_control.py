"""A quantity to an error: grids refined where it is decided, until its limit is known well enough.

Each round solves on a grid and on the one with all its elements cut, and says what the limit is and how well it is
known (:mod:`studies.solving.refinement.records`). Where that is not well enough, the difference between the two shows
which elements to cut (:mod:`studies.solving.refinement.indicators`), and the next round begins. A grid whose elements
have modes by themselves is none: its mesh is made finer across them, and the round begins again.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from contact.problem import Outcome
from studies.ask.request import Request
from studies.ask.scene import RefinedScene, Scene, ShellSceneModel, UsageError
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.refinement.goal import OnGrid, on_grid
from studies.solving.refinement.indicators import indicators
from studies.solving.refinement.nested import quarter
from studies.solving.refinement.point_loads import no_limit
from studies.solving.refinement.records import (
    Round,
    at_loads,
    estimate,
    of_rounds,
    record_estimate,
    record_loads,
    record_rounds,
)
from studies.solving.refinement.trees import Family
from studies.solving.result import Result
from studies.solving.solve import solve

MOST = 60_000  # unknowns of the next finer grid, at which a round is not begun
FEWEST, MOST_ROUNDS = 2, 8
TOO_COARSE = 2  # times that a coarsest grid which cannot carry the load, or lacks the quantity, is cut everywhere


def parse_error(text: str) -> float:
    """The relative error of "1%" or "0.01"; raises UsageError unless it is in [0.01%, 50%]."""
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        value = float("nan")
    if not 1e-4 <= value <= 0.5:
        raise UsageError(f"error {text!r} must be a part of the quantity in [0.01%, 50%], as 1% or 0.01")
    return value


def coarsest(
    name: str, given: Mapping[str, object], mesh: str | Sequence[int] | None = None, **options: Any
) -> tuple[Scene, Request]:
    """The scene and its request on the grid from which a refinement sets out; ``complete`` of scenes says how.

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
    return scene.coarsest_mesh if isinstance(scene, RefinedScene) else quarter(scene)


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
    The table ``loads`` states every load. No limit is stated for what has none under a point load.
    """
    family, rounds, seen_at = Family.of(scene, request), list[Round](), list[list[Round]]()
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
        quantity = quantity or default_quantity(scene, coarse.quantities)
        finer = family.everywhere()
        if quantity not in coarse.quantities:
            if too_coarse == TOO_COARSE or not _may_come(scene, quantity):
                raise UsageError(f"{scene.name} has no quantity {quantity!r}; it has {', '.join(coarse.quantities)}")
            family, too_coarse = finer, too_coarse + 1
            continue
        fine = solve(scene, finer.asked, progress)
        if not fine.outcome.converged:
            return fine, False
        if quantity not in fine.quantities:
            fine.reason = f"the grid of {fine.counters['dofs']} unknowns has no {quantity}, though a coarser one has it"
            return fine, False
        shorter = family.shortened(scene, fine)
        if shorter is not family:
            family, known = shorter, None
            continue
        unknowns, most_unknowns = (int(each.counters["dofs"]) for each in (coarse, fine))
        value, finer_value = coarse.quantities[quantity], fine.quantities[quantity]
        following, rim = _next(family, finer, coarse, fine, quantity)
        seconds = time.process_time() - start, fine.timing["cpu"]
        rounds.append(Round(value, finer_value, unknowns, most_unknowns, *seconds, rim, coarse.timing["cpu"]))
        seen_at.append(at_loads(coarse, fine, quantity, rounds[-1]))
        record_rounds(fine, quantity, rounds)
        reason = no_limit(fine, quantity, error)
        if reason:
            fine.reason = reason
            return fine, False
        found = estimate(rounds)
        progress(f"{quantity} {found}")
        record_estimate(fine, quantity, found, error)
        record_loads(fine, quantity, of_rounds(seen_at))
        if len(rounds) >= FEWEST and found.uncertainty <= error:
            return fine, True
        if most_unknowns > most / 2 or following.asked == family.asked:  # too many, or all that is marked is deepest
            break
        family = following
        known = fine if family.asked == finer.asked else None
    fine.reason = f"no grid of up to {most} unknowns has a {quantity} that is surely within {100 * error:g} %"
    return fine, False


def default_quantity(scene: Scene, quantities: Mapping[str, float]) -> str:
    """The force, the first quantity with a reference, or the first of all."""
    named = ["force_N", *(reference.quantity for reference in scene.references), *quantities]
    return next(name for name in named if name in quantities)


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


def _may_come(scene: Scene, quantity: str) -> bool:
    """Whether a quantity that a grid lacks may come with finer ones: of a limit point, or with a reference."""
    return "limit_" in quantity or quantity in {reference.quantity for reference in scene.references}
