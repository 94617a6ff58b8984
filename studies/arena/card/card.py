"""The card of one part: its laws and trials, the figures derived from them, and the verdict in one sentence.

Every number and verdict of the page is computed here; formatting is left to the page.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from formulations.geometry.grid import Grid
from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import FULL
from studies.arena.card.laws import laws_of, solver_laws
from studies.arena.card.problems import GROUPS, HARD
from studies.arena.card.runs import ALGORITHM, EXACT, MEASURE, REFERENCE, SOLVER, Subject, element, trials
from studies.arena.card.trials import ALIKE, DIFFERS, ENDS, FALSE, RAISED, REFUSED, SOLVED, Ended, guarded
from studies.arena.solver_summaries import within
from studies.experiments.conformance import LINES1, LINES2, TORUS, Check, conformance
from studies.experiments.specimens import ELEMENTS, Element, layup

TWICE = 2.0  # of the least cost: what is within it counts as cheap
LAWS_S = 60.0  # of all laws of a measure on an element, processor time
AT_REST = 1e-12  # relative, of tangents
FIGURES = {"solved share": "", "operations": "operations", "seconds": "seconds"}
Tell = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Card:
    """A part, its laws, and all trials (rows of :class:`studies.arena.card.trials.Trial`), of our parts as well."""

    subject: Subject
    laws: tuple[Check, ...]
    tries: pd.DataFrame

    @property
    def own(self) -> pd.DataFrame:
        """The trials of the part itself."""
        return self.tries[self.tries["who"] == self.subject.name]

    def ended(self, *ends: str) -> pd.DataFrame:
        """Its trials with one of these ends."""
        return self.own[self.own["ended"].isin(ends)]

    @property
    def broken(self) -> list[Check]:
        """The laws that it breaks."""
        return [law for law in self.laws if not law.passed]

    @property
    def compared(self) -> pd.DataFrame:
        """Its answers that were compared with others."""
        return self.own[self.own["agreement"] != ""]

    @property
    def different(self) -> pd.DataFrame:
        """Its answers that differ without an explanation."""
        return self.own[self.own["agreement"] == DIFFERS]

    @property
    def failed(self) -> dict[str, list[str]]:
        """Reasons for failure by kind: false claims, exceptions, broken laws, unexplained differences of answers."""
        failures = {
            "false claims on": list(self.ended(FALSE)["problem"]),
            "exceptions on": list(self.ended(RAISED)["problem"]),
            "laws broken:": [law.law for law in self.broken],
            "other answers on": list(self.different["problem"]),
        }
        return {what: names for what, names in failures.items() if names}

    @property
    def passes(self) -> bool:
        """Whether all laws are kept, all answers agree or are explained, nothing is raised, and no claim is false."""
        return not self.failed

    @property
    def verdict(self) -> str:
        """One sentence: passed or failed, on how many problems, and what failed."""
        counts = {word: len(self.ended(word)) for word in ENDS}
        sentence = f"solves {counts.pop(SOLVED)} of {len(self.own)} problems"
        sentence += "".join(f", {word} on {count}" for word, count in counts.items() if count)
        sentence += "" if counts[FALSE] else ", no claim is false"
        sentence += f"; {len(self.laws) - len(self.broken)} of {len(self.laws)} laws are kept"
        sentence += f", {len(self.different)} of {len(self.compared)} answers differ from {self.held_against}"
        sentence += "".join(f"; {what} {_listed(names)}" for what, names in self.failed.items())
        return f"`{self.subject.name}` {'passes' if self.passes else 'FAILS'}: it {sentence}."

    @property
    def held_against(self) -> str:
        """What its answers should be: of an algorithm or a solver the exact ones, else what another algorithm finds."""
        return "the exact ones" if self.subject.kind in (ALGORITHM, SOLVER) else f"those of `{EXACT[1]}` with it"

    @property
    def reference(self) -> str:
        """The part of ours that its cost is compared with; the next one where the part is the reference itself."""
        first = REFERENCE[self.subject.kind]
        if self.subject.name != first:
            return first
        return next(name for name in self.tries["who"].unique() if name != first)

    def ratios(self) -> pd.DataFrame:
        """A row per problem and part: operations and seconds over those of the reference, where both solve it.

        NaN where one of them does not: ``ended`` has the reason.
        """
        keys = ["group", "problem"]
        unit = self.tries[(self.tries["who"] == self.reference) & (self.tries["ended"] == SOLVED)]
        unit = unit.set_index(keys)[["operations", "seconds"]].add_suffix("_of_reference")
        rows = self.tries.join(unit, on=keys)
        solved = rows["ended"] == SOLVED
        for cost in ("operations", "seconds"):
            of = rows[f"{cost}_of_reference"]
            rows[f"{cost}_ratio"] = (rows[cost] / of.where(of > 0)).where(solved & (rows[cost] > 0))
        return rows

    def place(self) -> pd.DataFrame:
        """Its rank among ours in every figure: figure, rank, of, value, best, who is best, problems.

        On the problems that it does not refuse.  solved share: of those that are not refused.  operations, seconds:
        share of the problems solved with at most TWICE the least cost; a failure is never within it. A solution that
        counts none has a cost that is not known: where it is its own, the problem is left out.
        """
        put = self.own.loc[self.own["ended"] != REFUSED, ["group", "problem"]]
        rows = self.tries.merge(put, on=["group", "problem"])
        rows = rows[rows["ended"] != REFUSED]
        places = []
        for figure, cost in FIGURES.items() if len(put) else ():
            known = len(put)
            if cost:
                solved = rows["ended"] == SOLVED
                costs = rows[cost].where(rows[cost] > 0).where(solved, np.inf)
                if not np.isfinite(costs[rows["who"] == self.subject.name]).any():
                    continue  # it counts no operations, or solves nothing
                matrix = rows.assign(cost=costs).pivot_table(
                    index=["group", "problem"], columns="who", values="cost", sort=False
                )
                matrix = matrix[matrix[self.subject.name].notna()]
                known, shares = len(matrix), _cheap(matrix)
            else:
                shares = (rows["ended"] == SOLVED).groupby(rows["who"]).mean()
            mine = float(shares[self.subject.name])
            rank = 1 + int((shares > mine + 1e-12).sum())
            places.append((figure, rank, len(shares), mine, float(shares.max()), str(shares.idxmax()), known))
        return pd.DataFrame(places, columns=["figure", "rank", "of", "value", "best", "who", "problems"])

    def hard(self) -> pd.DataFrame:
        """How each part ends at the hard points: a row per point, a column per part."""
        rows = self.tries[self.tries["group"] == HARD]
        return rows.pivot(index="problem", columns="who", values="ended").reindex(rows["problem"].unique())

    @property
    def drawn(self) -> pd.DataFrame:
        """The data of the figure: part, problem, end, and cost over that of the reference, in operations if counted."""
        ratios = self.ratios()
        counted = ratios.loc[ratios["who"] == self.subject.name, "operations_ratio"].notna().any()
        cost = "operations" if counted else "seconds"
        table = ratios[["who", "problem", "ended"]].assign(ratio=ratios[f"{cost}_ratio"], cost=cost)
        return table[table["who"] != self.reference]

    @property
    def told(self) -> dict[str, Any]:
        """All values of the page, by their names in the template."""
        own, ratios = self.own, self.ratios()
        counts = pd.crosstab(own["group"], own["ended"]).reindex(own["group"].unique()).reindex(columns=ENDS).fillna(0)
        counts = counts.astype(int).assign(tried=counts.sum(axis=1).astype(int))
        laws = [
            {**vars(law), "word": "refused" if law.refused else "kept" if law.passed else "**broken**"}
            | {"said": law.refused or law.said}
            for law in sorted(self.laws, key=lambda law: (law.passed, bool(law.refused)))
        ]
        return {
            **{"kind": self.subject.kind, "name": self.subject.name, "verdict": self.verdict, "alike": ALIKE},
            "held_against": self.held_against,
            **{"origin": f"`{self.subject.file}`" if self.subject.file else "the suite", "reference": self.reference},
            **{"groups": counts.rename(GROUPS).rename_axis("group").reset_index(), "laws": laws, "twice": TWICE},
            **{"own": ratios[ratios["who"] == self.subject.name], "place": self.place()},
            "hard": self.tries.iloc[:0] if self.subject.kind == SOLVER else self.hard(),
        }


def _listed(names: Sequence[str], most: int = 5) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def _cheap(matrix: pd.DataFrame) -> pd.Series:
    """Share of its problems that each solves at TWICE the least cost; NaN: not put to it, or not known."""
    finite = matrix[np.isfinite(matrix.min(axis=1))]
    return within(finite, (TWICE,)).iloc[0] * len(finite) / finite.notna().sum().clip(lower=1)


def card_of(subject: Subject, tell: Tell = lambda name: None) -> Card:
    """The card of a part; raises UsageError where it cannot be run."""
    tell("laws")
    laws = tuple(_laws(subject))
    tries = pd.DataFrame([vars(trial) for trial in trials(subject, tell)])
    return Card(subject, laws, tries)


def _laws(subject: Subject) -> Iterator[Check]:
    if subject.kind == ALGORITHM:
        yield from laws_of(subject.name)
    elif subject.kind == SOLVER:
        yield from _tried(lambda: list(solver_laws(subject.name)))
    else:
        yield from _kit(subject)


def _kit(subject: Subject) -> Iterator[Check]:
    """The conformance kit on every element that suits a measure, or with the exact measure on those of an option.

    One row per law: of all elements the one that breaks it, or the largest value.
    """
    measure = MEASURES[subject.name if subject.kind == MEASURE else "exact"]
    fixed = {} if subject.kind == MEASURE else element(subject.name)
    suited = [each for each in dict.fromkeys(Element(**{**vars(e), **fixed}) for e in ELEMENTS) if each.suits(measure)]
    by_law: dict[str, list[Check]] = {}
    for each in suited:
        for check in _tried(partial(conformance, measure, each)):
            by_law.setdefault(check.law, []).append(
                replace(check, said=": ".join([" ".join(vars(each).values()), *filter(None, [check.said])]))
            )
    for laws in by_law.values():
        worst = max(laws, key=lambda law: (not law.passed, law.found))
        broken = sum(not law.passed for law in laws)
        yield replace(
            worst, said=f"broken on {broken} of {len(laws)}, as {worst.said}" if broken else f"on {len(laws)}"
        )
    if subject.kind == MEASURE:
        yield from _tried(lambda: [_at_rest(subject.name)])


def _tried(looked_at: Callable[[], list[Check]]) -> list[Check]:
    """These laws, or the one that a part breaks with which they cannot be looked at."""
    checks: list[Check] = []

    def look() -> Ended:
        checks.extend(looked_at())
        return Ended("")

    ended = guarded(look, LAWS_S)
    return checks if not ended.ended else [Check("its laws can be looked at", math.nan, said=ended.reason)]


def _at_rest(name: str) -> Check:
    """At zero displacement a measure with full gradients has the tangent of the exact one; only products may differ."""
    law, measure = "at rest it is the exact one", MEASURES[name]
    if measure.kinematics != FULL:
        return Check(law, math.nan, refused="its gradients leave something out")
    grid = Grid.tensor(LINES1, LINES2)
    rest = np.zeros(6 * grid.n_nodes)
    shells = (ELEMENTS[0].shell(each, TORUS, grid, layup()) for each in (measure, MEASURES["exact"]))
    own, exact = (shell.linearise(rest).tangent for shell in shells)
    return Check(law, float(abs(own - exact).max() / abs(exact).max()), 0.0, AT_REST)
