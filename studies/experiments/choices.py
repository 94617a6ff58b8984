"""What is enough, regime by regime: ``footprint choose`` on scenes of every regime of deformation, to two errors.

Every formulation is compared in the limit of its grids, with the uncertainty of that. What counts as enough is decided
in :mod:`studies.solving.choose`; which sentence follows is not known here.
"""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from studies.ask.request import text_of
from studies.experiments.error_coverage import settings_of
from studies.solving.choice import Choice
from studies.solving.choose import choose, loosened
from studies.solving.offers import Offer

ERRORS = (0.05, 0.01)
SMALL, LARGE, PATCH = "small rotations", "large rotations", "contact"
OFFER, VARIANT, GRID, ALGORITHM = "offer", "variant", "grid", "algorithm"  # what a row is
BUDGET = 120.0  # s of wall time
PROBLEM = ["scene", "settings"]  # the columns that tell problems apart
COARSE = 0.5  # of the unknowns of the exact measure's finest grid, below which a limit rests on coarse grids
KEYS = [*PROBLEM, "name"]
OFFERS = 2  # the one recommended and the runner-up
COLUMNS = (
    *(
        "regime",
        "scene",
        "settings",
        "quantity",
        "limit",
        "asked",
        "row",
        "axis",
        "name",
        "surfaces",
        "contact",
        "mesh",
    ),
    *("unknowns", "formulation_error", "within", "verdict", "error_at_most", "seconds", "iterations", "tried"),
    *("agrees", "said", "command"),
)


@dataclass(frozen=True)
class Ask:
    """A quantity of a scene; the first one that it has references for where none is named."""

    regime: str
    scene: str
    settings: Mapping[str, str] = field(default_factory=dict)
    quantity: str | None = None
    budget: float = BUDGET


def shipped_asks() -> Iterator[Ask]:
    """Those of ``choices.csv``, regime by regime; ``budget_s``: more of what has many unknowns."""
    with Path(__file__).with_name("choices.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            given = settings_of(row["settings"])
            yield Ask(row["regime"], row["scene"], given, row["quantity"] or None, float(row["budget_s"]))


def choices(asks: Iterable[Ask] | None = None, errors: Sequence[float] = ERRORS) -> pd.DataFrame:
    """COLUMNS, rows of four kinds for each quantity and error asked for.

    What the smallest error takes says what larger ones take, too; where it has no answer they are asked for themselves.
    offer: what is recommended, and the runner-up; ``tried``: solved from rest and certified.  variant: a measure, an
    option of the element, a wall with more surfaces or a model, with its formulation_error in the limit of the grids,
    known to ``within``, from ``limit``, that of the exact measure on the wall with the most surfaces.
    surfaces: of its wall, where they are not those of the scene.  grid: of the measures, with the most that it may be
    off.  algorithm: from rest on a mesh; ``agrees``: with the default, to the judge.  seconds: CPU time, of a path from
    the grid before in the rows of variants and grids.
    """
    rows = list[dict[str, Any]]()
    for ask in shipped_asks() if asks is None else asks:
        for choice in _found(ask, errors):
            settings = " ".join(f"{key}={text_of(value)}" for key, value in ask.settings.items())
            head: dict[str, Any] = {
                "regime": ask.regime,
                "scene": ask.scene,
                "settings": settings,
                "quantity": choice.quantity,
            }
            head["limit"] = np.nan if choice.truth is None else choice.truth.limit
            rows += [{**head, "asked": choice.question.error, **row} for row in _rows(choice)]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _found(ask: Ask, errors: Sequence[float]) -> Iterator[Choice]:
    """The largest error first."""
    known: Choice | None = None
    answers = []
    for error in sorted(errors):
        with np.errstate(over="ignore", invalid="ignore"):
            if known is None or known.limit is None:
                known = answer = choose(ask.scene, ask.settings, error, ask.budget, ask.quantity)
            else:
                answer = loosened(known, error)
        answers.append(answer)
    yield from reversed(answers)


def smallest(table: pd.DataFrame, row: str, axis: str) -> pd.DataFrame:
    """The rows of a kind and an axis, each problem's for the smallest error that it has any for; settings as text."""
    own = table[(table["row"] == row) & (table["axis"] == axis)]
    own = own.assign(settings=own["settings"].fillna("").astype(str))
    return own[own["asked"] == own.groupby(PROBLEM)["asked"].transform("min")]


def measure_limits(table: pd.DataFrame) -> pd.DataFrame:
    """The rows of the measures, one a problem and measure: of the smallest error for which its own limit is known.

    coarse: whether its finest grid has less than COARSE of the unknowns of the exact measure's.
    """
    table = table.assign(settings=table["settings"].fillna("").astype(str))
    of_measures = table[table["axis"] == "measure"]
    own = of_measures[of_measures["row"] == VARIANT]
    own = own.assign(lost=own["formulation_error"].isna())
    first = own.sort_values(["lost", "asked"], kind="stable").drop_duplicates(KEYS)
    grids = of_measures[of_measures["row"] == GRID].groupby([*PROBLEM, "name"], as_index=False)["unknowns"].max()
    exact = grids[grids["name"] == "exact"].drop(columns="name")
    finest, most = (first[keys].merge(rows, how="left")["unknowns"] for keys, rows in ((KEYS, grids), (PROBLEM, exact)))
    return first.assign(coarse=(finest < COARSE * most).to_numpy()).sort_index().drop(columns="lost")


def _rows(choice: Choice) -> Iterator[dict[str, Any]]:
    if not choice.offers:
        yield {"row": OFFER, "said": choice.reason}
    yield from ({"row": OFFER, **_offer(offer)} for offer in choice.offers[:OFFERS])
    for kind, each in chain(product((VARIANT,), choice.variants), product((GRID,), choice.grids)):
        yield {"row": kind, **each, "seconds": each["path_seconds"]}
    for each in choice.trials:
        names = {"contact": each["name"], "iterations": each["newton_iterations"], "verdict": each["ended"]}
        yield {"row": ALGORITHM, "axis": ALGORITHM, **each, **names}


def _offer(offer: Offer) -> dict[str, Any]:
    known = {"error_at_most": offer.error_at_most, "seconds": offer.seconds, "tried": offer.holds}
    what = {"axis": offer.variant.axis, "name": offer.variant.name, "surfaces": offer.variant.wall}
    return {**what, "contact": offer.contact, "mesh": offer.mesh, **known, "command": offer.command}
