"""``from footprint import solve, describe``: what a notebook calls, with Python's values, data frames and figures.

It adds nothing of its own: requests are checked, solved and drawn as for the command line, and advice, cards and
judgements are what the commands of the same names print.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.answers import Chosen, Run, Swept
from studies.ask.request import UsageError, text_of
from studies.ask.settings import rubbing
from studies.catalogue import descriptions
from studies.catalogue.descriptions import Description, Scenes
from studies.scenes.complete import complete
from studies.scenes.plugins import load_entry_points
from studies.solving import choose as choosing
from studies.solving.choose import BUDGET, ERROR
from studies.solving.refinement.cascade import parse_budget
from studies.solving.refinement.error_control import parse_error
from studies.solving.refinement.mesh_error import NESTED, STARTS, solve_with_error
from studies.sweeps import sweep as sweeping

if TYPE_CHECKING:  # each is loaded by its own question alone
    import pandas as pd

    from studies.analysis.advice.choose import Advice
    from studies.arena.answers import Judgement
    from studies.arena.card.card import Card


def solve(
    scene: str,
    *,
    measure: str = "exact",
    contact: str = "semismooth",
    newton: str = "mixed",
    mesh: str | Sequence[int] | None = None,
    model: str = "auto",
    steps: int = 1,
    start: str = NESTED,
    mesh_error: bool = True,
    step_error: bool = True,
    **settings: Any,
) -> Run:
    """Solve a scene; settings are its keys, as values or as text.

    start: of the path, ``nested`` from its states on coarser grids, or ``cold`` from rest; the answer is the same.
    mesh_error: state what these grids say of the error of the mesh.
    step_error: with friction, solve the path again with half the load steps for the error that they leave.

    Raises UsageError with one line for a wrong name, key or value, and where the algorithm does not apply.
    """
    load_entry_points()
    built, request = complete(
        scene, settings, mesh, measure=measure, contact=contact, newton=newton, model=model, steps=steps
    )
    if start not in STARTS:
        raise UsageError(f"start = {start!r} must be one of {', '.join(STARTS)}")
    result = solve_with_error(built, request, start=start, error=mesh_error)
    if result.unsupported:
        raise UsageError(result.unsupported)
    if step_error and rubbing(request.settings):
        from studies.solving import load_steps  # loaded with friction alone

        load_steps.estimate(result)
    return Run(result)


def choose(
    scene: str,
    error: str | float = ERROR,
    *,
    budget: str | float = BUDGET,
    of: str | None = None,
    contact: str = "semismooth",
    newton: str = "mixed",
    mesh: str | Sequence[int] | None = None,
    model: str = "auto",
    steps: int = 1,
    **settings: Any,
) -> Chosen:
    """Which measure, algorithm, element and mesh is enough on a scene; settings are its keys, as values or as text.

    error: relative, "1%" or 0.01.  budget: seconds of wall time, 60 or "60s".  of: the quantity, by default the force,
    or the first of the scene.  mesh: the coarsest grid.

    Raises UsageError with one line for a wrong name, key or value.
    """
    load_entry_points()
    seconds, tolerance = parse_budget(str(budget)), parse_error(str(error))
    options: dict[str, Any] = {"contact": contact, "newton": newton, "model": model, "steps": steps}
    with np.errstate(over="ignore", invalid="ignore"):
        return Chosen(choosing.choose(scene, settings, tolerance, seconds, of, mesh=mesh, **options))


def sweep(
    scene: str,
    over: Mapping[str, str | Sequence[float]],
    error: str | float | None = None,
    *,
    of: str | None = None,
    keep: str | Path | None = None,
    mesh: str | Sequence[int] | None = None,
    **asked: Any,
) -> Swept:
    """Solve a scene over one or two settings; asked: measure, contact, newton, model, steps, and further settings.

    over: evenly spaced values or "A:B:N" by setting.  error: relative, "1%" or 0.01: coarser grids say whether each
    member is known so well.  of: the quantity, by default the force, or the first of the scene.  keep: a folder for
    finished members, which are read the next time. Raises UsageError with one line for a wrong name, key or value.
    """
    load_entry_points()
    tolerance, kept = None if error is None else parse_error(str(error)), None if keep is None else Path(keep)
    options = {key: asked.pop(key) for key in ("measure", "contact", "newton", "model", "steps") if key in asked}
    with np.errstate(over="ignore", invalid="ignore"):
        return Swept(sweeping.sweep(scene, asked, over, tolerance, of, kept, mesh=mesh, **options))


def describe(name: str) -> Description:
    """A scene, a measure or an algorithm; raises UsageError for an unknown name."""
    load_entry_points()
    return descriptions.describe(name)


scene = Scenes(solve)


def gradient(scene: str, quantity: str, *settings: str, check: bool = False, **asked: Any) -> pd.DataFrame:
    """dJ/ds of a quantity with settings, by default all that are continuous: a row a load and a setting.

    asked: what :func:`solve` takes. The columns and what ``check`` does: :meth:`studies.Run.gradient`.
    Raises UsageError for a wrong name, key or value, and for what has no derivative.
    """
    return solve(scene, **asked).gradient(quantity, *settings, check=check)


def advise(
    scene: str,
    error: str | float,
    *,
    quantity: str | None = None,
    cost: str = "seconds",
    store: str | Path | None = None,
    campaign: str = "standard",
    **settings: Any,
) -> Advice:
    """The cheapest configuration of a campaign whose error is surely no larger; settings: those it was solved with.

    error: relative, "1%" or 0.01.  quantity: by default the first of the scene.  cost: seconds, dofs or operations.
    store: of the campaign, by default the tables that come with the suite.  ``best`` of the answer is None where no
    configuration is enough.  Raises UsageError for a scene, quantity or setting that was not solved.
    """
    from studies.analysis.advice.choose import advise as advise_on
    from studies.analysis.advice.choose import question_of

    load_entry_points()
    given = {key: text_of(value) for key, value in settings.items()}
    question = question_of(scene, quantity, given, cost, None if store is None else Path(store), campaign)
    return advise_on(question, parse_error(str(error)))


def card(part: str | Path) -> list[Card]:
    """A card for each part that a file adds, or of the part of ours with this name; takes minutes.

    ``verdict`` is its first sentence, ``passes`` what ``footprint card --check`` asks. Raises UsageError for what is no
    part.
    """
    from studies.arena.card.card import card_of
    from studies.arena.card.runs import subjects

    load_entry_points()
    return [card_of(subject) for subject in subjects(str(part))]


def judge(problem: str | Path, answer: str | Path, tolerance: float | None = None) -> Judgement:
    """The residuals of an answer to a frozen contact problem, recomputed, and every claim held against them.

    problem: a .npz.  answer: a .npz or .json with du [mm], pressure [MPa] and claims; with friction du, normal and
    friction [N].  tolerance: the accuracy that is asked for, by default 1e-8; with friction the judge has its own
    bounds.  Raises UsageError for what is not a problem or no answer, and for a file that cannot be read.
    """
    from studies.arena.replay import judge_files

    try:
        return judge_files(Path(problem), Path(answer), tolerance)
    except OSError as error:
        raise UsageError(f"{error.filename}: {error.strerror}") from None
