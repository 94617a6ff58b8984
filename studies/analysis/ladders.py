"""Ladders of meshes: values, orders, limits and verdicts, and their errors against references in a mesh and model part.

    finest - reference = (finest - limit) + (limit - reference) = mesh part + model part, all over the reference

A model part counts where it is larger than the uncertainties of limit and reference together.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from studies.ask.declarations import Ladder
from studies.ask.scene import Reference
from studies.run.answers import Answer, Answers, ladders
from studies.run.lists import BENCHMARKS, LADDER_LABEL, LADDERS
from studies.scenes.complete import STEP_KEYS, holding
from studies.solving.refinement.richardson import MeshSequence

COLUMNS = (
    *("sequence", "ladder", "family", "element", "scene", "measure", "quantity", "at", "mesh", "value"),
    *("order", "verdict", "asymptotic", "cause", "limit", "uncertainty", "label", "command"),
)
ERROR_COLUMNS = (
    *("sequence", "ladder", "element", "scene", "quantity", "asymptotic", "kind", "value", "uncertainty", "source"),
    *("error", "model_part", "limit_uncertainty", "verdict"),
)
SUMMARY_COLUMNS = (
    *("group", "scenes", "sequences", "asymptotic", "limits", "median_uncertainty"),
    *("comparisons", "agree", "median_off", "largest_off", "largest_off_in"),
)
OWN = "refined"  # the kind of a reference that is a limit of our own grids
STRAINS = {"exact": "exact strains", "linear": "linear strains"}
DEFAULT = "refined"
WITHIN, BEYOND, NO_LIMIT = "within the uncertainties", "beyond the uncertainties", "no limit"
ELEMENTS = {"refined": True, "paper": False}  # by name, whether its ladders have their finest mesh


@dataclass(frozen=True, eq=False)
class Rungs:
    """One quantity on the meshes of a ladder, coarse to fine; at: the load it is read at, empty for the whole path.

    ladder, family: empty for cells that no ladder has planned.  answers: None for a mesh that has no record.
    cause: why it is not asymptotic, as its ladder has it.
    """

    ladder: str
    family: str
    element: str
    quantity: str
    at: Mapping[str, float]
    meshes: tuple[str, ...]
    labels: tuple[str, ...]
    answers: tuple[Answer | None, ...]
    sizes: tuple[float, ...]
    cause: str = ""

    @property
    def finest(self) -> Answer | None:
        """The last answer that there is."""
        return next((answer for answer in reversed(self.answers) if answer is not None), None)

    @property
    def sequence(self) -> MeshSequence:
        """Its values, NaN where a mesh was not solved."""
        values = (math.nan if answer is None else answer.value(self.quantity, **self.at) for answer in self.answers)
        return MeshSequence(self.sizes, tuple(values))

    @property
    def references(self) -> list[Reference]:
        """Those of the scene that hold for what was solved; no error is relative to zero."""
        if self.finest is None:
            return []
        last = self.finest.steps[-1] if self.finest.steps else {}
        there = {**self.finest.settings, "measure": self.finest.record["measure"]}
        there |= {key: self.at.get(key, last.get(key)) for key in STEP_KEYS}
        return [each for each in holding(self.finest.record["scene"], there) if each.quantity == self.quantity]


def convergence(answers: Answers, table: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """COLUMNS, a row a mesh of every sequence, and ERROR_COLUMNS, a row a reference of it; error: of the finest mesh.

    table: collected, of whose cells those belong together that differ in the mesh only.  order: of the three meshes
    that end with this one.
    """
    rows: list[list[object]] = []
    errors: list[list[object]] = []
    for i, rungs in enumerate((*_planned(answers), *_others(answers, table))):
        sequence = rungs.sequence
        rows += _rows(i, rungs, sequence)
        errors += [_error(i, rungs, sequence, reference) for reference in rungs.references]
    return pd.DataFrame(rows, columns=list(COLUMNS)), pd.DataFrame(errors, columns=list(ERROR_COLUMNS))


def _planned(answers: Answers) -> Iterator[Rungs]:
    """The ladders that the campaign has planned, with each element, and the benchmarks at every load."""
    for element, finest in ELEMENTS.items():
        for ladder in LADDERS:
            named = {"ladder": ladder.name, "element": element}
            labels = {mesh: LADDER_LABEL.format(mesh=mesh, **named) for mesh in ladder.climbed(finest=finest)}
            key, _, value = ladder.at.partition("=")
            at = [{key: float(value)} if key else {}]
            yield from _of_ladder(answers, ladder, element, labels, at)
    for ladder in BENCHMARKS:
        labels = {mesh: f"{ladder.name} {mesh.split('x')[0]}" for mesh in ladder.meshes}
        first = answers.get(labels[ladder.meshes[0]])
        loads = [] if first is None else first.settings["load_fraction"]
        yield from _of_ladder(answers, ladder, "paper", labels, [{"load_fraction": load} for load in loads])


def _of_ladder(
    answers: Answers, ladder: Ladder, element: str, of: Mapping[str, str], loads: Sequence[Mapping[str, float]]
) -> Iterator[Rungs]:
    """of: labels by mesh."""
    meshes, labels = tuple(of), tuple(of.values())
    if not any(label in answers.planned for label in labels):
        return
    solved = tuple(map(answers.get, labels))
    sizes = tuple(1 / int(mesh.split("x")[0]) for mesh in meshes)
    for quantity in ladder.quantities:
        cause = ladder.causes.get(quantity, "")
        for at in loads:
            yield Rungs(ladder.name, ladder.family, element, quantity, at, meshes, labels, solved, sizes, cause)


def _others(answers: Answers, table: pd.DataFrame) -> Iterator[Rungs]:
    """All requests that have converged on three meshes or more: their quantities with references, else the first."""
    for group in ladders(table):
        labels, sizes = tuple(group["label"]), tuple(group["size"].astype(float))
        solved = tuple(map(answers.get, labels))
        assert solved[-1] is not None
        every = [
            Rungs("", "", "", quantity, {}, tuple(group["mesh"]), labels, solved, sizes)
            for quantity in solved[-1].record["quantities"]
        ]
        yield from [rungs for rungs in every if rungs.references] or every[:1]


def _rows(i: int, rungs: Rungs, sequence: MeshSequence) -> Iterator[list[object]]:
    orders = (math.nan, math.nan, *sequence.orders)
    finest = rungs.finest
    who = ["", ""] if finest is None else [finest.record[key] for key in ("scene", "measure")]
    at = ",".join(f"{key}={value:g}" for key, value in rungs.at.items())
    verdict = [sequence.verdict, sequence.asymptotic, rungs.cause, sequence.limit, sequence.uncertainty]
    for j, (mesh, answer) in enumerate(zip(rungs.meshes, rungs.answers, strict=True)):
        yield [
            *(i, rungs.ladder, rungs.family, rungs.element, *who, rungs.quantity, at),
            *(mesh, sequence.values[j], orders[j], *verdict),
            *(rungs.labels[j], "" if answer is None else answer.command),
        ]


def summary(data: pd.DataFrame, errors: pd.DataFrame) -> pd.DataFrame:
    """SUMMARY_COLUMNS of the planned ladders with the default element: a row for each of STRAINS, then a row a family.

    limits (that exist), median_uncertainty of them (relative).  comparisons: of limits with references but for our OWN
    limits; agree: within the uncertainties of both; median_off, largest_off: sizes of their differences, the largest in
    the ladder largest_off_in.
    """
    own = data[(data["element"] == DEFAULT) & (data["ladder"] != "")].drop_duplicates("sequence")
    own = own.assign(known=(own["uncertainty"] / own["limit"]).abs())
    judged = errors[errors["kind"] != OWN].dropna(subset=["model_part"])
    strains = [(words, own[own["measure"] == name]) for name, words in STRAINS.items()]
    rows = []
    for group, each in [*strains, *own.groupby("family", sort=False)]:
        known = each.dropna(subset=["known"])
        compared = judged[judged["sequence"].isin(each["sequence"])]
        off = compared["model_part"].abs()
        where = str(compared["ladder"].iloc[int(off.argmax())]) if len(off) else ""
        rows.append(
            [
                *(group, each["ladder"].nunique(), len(each), int(each["asymptotic"].astype(bool).sum()), len(known)),
                known["known"].median(),
                *(len(compared), int((compared["verdict"] == WITHIN).sum()), off.median(), off.max(), where),
            ]
        )
    return pd.DataFrame(rows, columns=list(SUMMARY_COLUMNS))


def _error(i: int, rungs: Rungs, sequence: MeshSequence, reference: Reference) -> list[object]:
    value, own = reference.value, abs(sequence.uncertainty / reference.value)
    model = sequence.limit / value - 1
    scene = rungs.finest.record["scene"] if rungs.finest else ""
    return [
        *(i, rungs.ladder, rungs.element, scene, rungs.quantity, sequence.asymptotic),
        *(reference.kind, value, reference.uncertainty, reference.source),
        *(sequence.values[-1] / value - 1, model, own, verdict_of(model, own, reference.uncertainty)),
    ]


def verdict_of(model: float, limit_uncertainty: float, reference_uncertainty: float) -> str:
    """Is the model part more than the uncertainty of limit and reference? All relative."""
    if math.isnan(model):
        return NO_LIMIT
    return WITHIN if abs(model) <= limit_uncertainty + reference_uncertainty else BEYOND
