"""All tables of the catalogue's sheets, for a campaign that solves their cells."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from studies.catalogue.bodies import drawn_bodies, marks
from studies.catalogue.models import Built, built_models
from studies.catalogue.parts import facts, laws, parts, plies, settings, terms
from studies.catalogue.values import answered, values
from studies.run.campaigns.sheet_cells import GROUP
from studies.run.cells.answers import Answers


def catalogue_tables(
    store: Path, campaign: str, convergence: pd.DataFrame, models: Iterable[Built] | None = None
) -> dict[str, pd.DataFrame]:
    """By name; none for a campaign without such cells.  models: of all scenes, unless some are given."""
    answers = Answers.of(store, campaign)
    if not any(row.get("group") == GROUP for row in answers.planned.values()):
        return {}
    built = list(built_models() if models is None else models)
    points, quads = drawn_bodies(answers)
    return {
        "sheet_parts": parts(),
        "sheet_settings": settings(),
        "sheet_facts": facts(built),
        "sheet_plies": plies(built),
        "sheet_terms": terms(),
        "sheet_laws": laws(),
        "sheet_values": values(answers, convergence),
        "sheet_answers": answered(answers),
        "sheet_marks": marks(built),
        "sheet_points": points,
        "sheet_quads": quads,
    }
