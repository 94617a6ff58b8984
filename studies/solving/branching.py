"""The stable branches beside an unstable result, at the same load: what ``footprint solve --branch`` finds.

What a branch is, and how it is reached, is the business of :mod:`contact.continuation.branches`.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from contact.continuation.branches import Branch, stable_branches
from contact.solvers.sparse import SingularMatrixError
from studies.ask.request import Request, UsageError
from studies.ask.scene import CurveStage, Stage, moved
from studies.ask.settings import configured, rubbing
from studies.output.atomic import write_by
from studies.solving.certificate import certificate
from studies.solving.result import Result

FORCE = "force_N"
NO_LOAD = "--branch needs a converged load at the end: a traced curve or a path that has stopped has none"


def check(request: Request, stages: Iterable[Stage]) -> None:
    """Raise UsageError where the end of these stages has no branches to leave for, whatever its state."""
    if rubbing(request.settings):
        raise UsageError("--branch needs a potential: friction has none")
    *_, last = stages
    if isinstance(last, CurveStage):
        raise UsageError(NO_LOAD)


def branches_of(result: Result) -> list[dict[str, Any]]:
    """A row each way along the unstable mode of the last state; none where it is stable.

    side: +1 or -1; found: whether the descent has ended at a stable equilibrium that the judge certifies; said: of it,
    or why not; what the scene reads off there, with ``change_of_force`` relative to the unstable state, the distance
    ``away`` over all displacement, and the factorisations spent.  ``files`` of the fields come with :func:`write`.
    Raises UsageError where there is no state to leave.
    """
    visited = result.end
    if visited is None or not visited.converged:
        raise UsageError(NO_LOAD)
    check(result.request, [visited.stage])
    algorithm = configured(result.request.contact, result.request.settings)
    try:
        branches = stable_branches(visited.problem, visited.point.solution, algorithm)
    except (SingularMatrixError, ValueError) as error:
        raise UsageError(f"--branch: the modes of the tangent are not known: {error}") from None
    result.branches = [_row(result, branch) for branch in branches or ()]
    result.beside = list(branches or ())
    return result.branches


def _row(result: Result, branch: Branch) -> dict[str, Any]:
    """The state at the end of a descent."""
    visited = result.end
    assert visited is not None
    row: dict[str, Any] = {
        "side": branch.sign,
        "found": branch.found,
        "said": branch.reason or branch.stability.sentence,
    }
    row |= {"away": branch.away, "factorisations": int(branch.solution.counters.get("factorisations", 0))}
    if not branch.solution.outcome.converged:
        return row
    record = certificate(visited.problem, branch.solution, result.epsilon)
    if record["failures"]:
        row |= {"found": False, "said": f"the judge finds {', '.join(record['failures'])} beyond its bounds"}
    readings = visited.stage.observe(visited.problem, branch.solution, visited.point.requested).step or {}
    row |= {key: value for key, value in readings.items() if isinstance(value, int | float)}
    here = result.loads[-1].seen.get(FORCE) if result.loads else None
    if here and FORCE in readings:
        row["change_of_force"] = readings[FORCE] / here - 1
    return row


def write(result: Result, directory: Path) -> list[str]:
    """branch_1.vtu and branch_2.vtu: the fields of the stable branches that were found; returns their names."""
    visited, model = result.end, result.model
    if visited is None or model is None:
        return []
    by_file = {f"branch_{number}.vtu": branch for number, branch in enumerate(result.beside, 1) if branch.found}
    for name, branch in by_file.items():
        state = visited.stage.lifted(branch.solution)
        write_by(directory / name, partial(moved(model, visited.point.reached).write_fields, state=state))
    return list(by_file)


def lines(result: Result) -> list[str]:
    """What a terminal shows: one line a branch."""
    if not result.branches:
        return ["--branch: the last state has no unstable mode, so there is no branch to follow"]
    report = []
    for row in result.branches:
        side = "along" if row["side"] > 0 else "against"
        force = f", {FORCE} {row[FORCE]:.6g}" if FORCE in row else ""
        change = f" ({row['change_of_force']:+.3%})" if "change_of_force" in row else ""
        kind = "stable branch" if row["found"] else "no stable branch"
        report.append(
            f"{kind} {side} the unstable mode: {row['said']}{force}{change}; {row['factorisations']} factorisations"
        )
    return report
