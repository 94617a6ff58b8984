"""What a notebook asks beside solving: derivatives, advice, the card of a part, and what an answer is worth.

As :mod:`studies.notebook`, it says nothing of its own: each is what the command of the same name prints.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from studies.ask.request import UsageError, text_of
from studies.notebook import solve
from studies.scenes.plugins import load_entry_points
from studies.solving.refinement.error_control import parse_error

if TYPE_CHECKING:  # each is loaded by its own question alone
    from studies.analysis.advice.choose import Advice
    from studies.arena.answers import Judgement
    from studies.arena.card.card import Card


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
    bounds.  Raises UsageError for what is no problem or no answer, and for a file that cannot be read.
    """
    from studies.arena.replay import judge_files

    try:
        return judge_files(Path(problem), Path(answer), tolerance)
    except OSError as error:
        raise UsageError(f"{error.filename}: {error.strerror}") from None
