"""Section of the page of convergence: the default element against the one of the paper, over all scenes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reports import labels
from reports.ladders import Rung, read_ladders
from reports.markdown import NOTHING, Part, commands, percent, prose, table
from reports.tables import Store

ENOUGH = 0.01  # the error that a mesh is wanted for
EQUAL = 1e-3  # two errors this close are equal; so are two that the uncertainty of the limit does not tell apart


@dataclass(frozen=True, eq=False)
class Choice:
    """One quantity by both elements on the same meshes: relative errors against the common limit, coarse to fine.

    uncertainty: relative, of the limit.
    """

    rung: Rung
    uncertainty: float
    default: np.ndarray
    paper: np.ndarray

    @property
    def verdict(self) -> str:
        """On the coarsest mesh, where it costs: is the default better, equal, or worse?"""
        default, paper = abs(self.default[0]), abs(self.paper[0])
        if np.isnan(default) or np.isnan(paper):
            return "not solved by both"
        if abs(default - paper) <= max(EQUAL, self.uncertainty):
            return "equal"
        return "better" if default < paper else "worse"

    def elements(self, errors: np.ndarray) -> float:
        """Elements from which the error stays below ENOUGH, log-log between two meshes; NaN outside the meshes."""
        size = np.log([np.prod([int(n) for n in mesh.split("x")]) for mesh in self.rung.meshes[: len(errors)]])
        error = np.abs(errors)
        above = np.flatnonzero(~(error <= ENOUGH))
        if len(above) == 0 or above[-1] == len(error) - 1:
            return float("nan")
        i = above[-1]
        return float(np.exp(np.interp(np.log(ENOUGH), np.log(error[[i + 1, i]]), size[[i + 1, i]])))


def choices(store: Store) -> list[Choice]:
    """Every quantity that has a limit, which is that of the element whose limit is the more certain."""
    found = []
    pairs = zip(
        read_ladders(store, labels.LADDER_ELEMENT), read_ladders(store, labels.OTHER_ELEMENT, finest=False), strict=True
    )
    for default, paper in pairs:
        known = [s for s in (default.sequence, paper.sequence) if s.limit is not None and s.uncertainty is not None]
        if not known:
            continue
        best = min(known, key=lambda s: s.uncertainty or 0.0)
        limit, uncertainty = best.limit, best.uncertainty
        assert limit is not None
        assert uncertainty is not None
        count = len(paper.meshes)
        errors = [np.array(rung.sequence.values[:count]) / limit - 1 for rung in (default, paper)]
        found.append(Choice(default, abs(uncertainty / limit), *errors))
    return found


def element_choice_part(store: Store) -> Part:
    """The table, and what it says."""
    found = choices(store)
    counts = {word: sum(c.verdict == word for c in found) for word in ("better", "equal", "worse")}
    worse = [
        f"{c.rung.ladder} `{c.rung.quantity}` ({percent(c.paper[0])} by the paper's, {percent(c.default[0])})"
        for c in found
        if c.verdict == "worse"
    ]
    rows = []
    for c in found:
        pairs = [f"{percent(a)} / {percent(b)}" for a, b in zip(c.paper, c.default, strict=True)]
        pairs += [NOTHING] * (3 - len(pairs))
        rows.append([c.rung.ladder, f"`{c.rung.quantity}`", c.verdict, ", ".join(c.rung.meshes[:3]), *pairs[:3]])
        rows[-1] += [f"{_mesh(c, c.paper)} / {_mesh(c, c.default)}", _work(store, c)]
    nearer = sum(abs(c.default[0]) < abs(c.paper[0]) for c in found)
    farther = sum(abs(c.default[0]) > abs(c.paper[0]) for c in found)
    text = prose(f"""## Which element

The element of the paper (`element=paper`) against the default (`element=refined`), which samples the thickness strain
at the nodes and relaxes the linear membrane modes of curved elements. Both have the same unknowns and the same limit;
errors are relative to that limit, which is taken from the sequence whose limit is the more certain. On the coarsest
mesh the default is better for {counts["better"]} quantities, equal within {percent(EQUAL, 1, sign=False)} or within the
uncertainty of the limit for {counts["equal"]}, and worse for
{counts["worse"]}{": " + "; ".join(worse) if worse else ""}. By the bare numbers, however close, it is nearer for
{nearer} and farther for {farther}. *Elements for {percent(ENOUGH, 0, sign=False)}*: from which the error stays
below, interpolated; a dash where it is so on every mesh or on none. *Iterations*: of Newton's method over the whole
path on the second mesh.""")
    header = ["scene", "quantity", "default is", "meshes", "coarsest: paper / default", "second", "third"]
    header += [f"elements for {percent(ENOUGH, 0, sign=False)}", "iterations"]
    lines = commands(cell.command for c in found for cell in c.rung.cells[: len(c.paper)])
    return Part("\n\n".join([text, table("Errors of both elements", header, rows, words=4), lines]))


def _mesh(choice: Choice, errors: np.ndarray) -> str:
    found = choice.elements(errors)
    return NOTHING if np.isnan(found) else f"{found:.0f}"


def _work(store: Store, choice: Choice) -> str:
    """Newton iterations of both on the second mesh."""
    name, mesh = choice.rung.ladder, choice.rung.meshes[1]
    counts = []
    for element in (labels.OTHER_ELEMENT, labels.LADDER_ELEMENT):
        counters = store.cell(labels.CONVERGENCE.format(ladder=name, mesh=mesh, element=element)).result["counters"]
        counts.append(str(counters.get("newton_iterations", NOTHING)))
    return " / ".join(counts)
