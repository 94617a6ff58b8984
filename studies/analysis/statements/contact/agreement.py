"""Whether the contact algorithms agree on one answer: forces and contact sets beside those of the default."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from studies.analysis.cells.answers import Answer, Answers
from studies.analysis.statements.record import OPENING, Statement
from studies.campaigns.report_cells import agreement

AGREE = 1e-7  # relative difference of forces up to which two algorithms agree
REFERENCE = "semismooth"
CASE = ("load", "section")  # settings that change the problem


def algorithms_agree(answers: Answers) -> Iterator[Statement]:
    """Every solve with the exact condition against the reference of its case."""
    found = (each for each in answers.those(agreement()) if each.steps)  # what was refused has no state to compare
    solved = [each for each in found if each.settings["epsilon"] in ("inf", math.inf)]
    references = {_case(each): each for each in solved if each.label.startswith(f"agreement {REFERENCE} ")}
    others = [each for each in solved if _case(each) in references and each is not references[_case(each)]]
    pairs = [_unlike(each, references[_case(each)]) for each in others]
    if not pairs:
        return
    offs = [off for off, _ in pairs]
    agree = sum(off <= AGREE and nodes == 0 for off, nodes in pairs)
    values = {"agree": float(agree), "of": float(len(pairs)), "off": max(offs), "bound": AGREE}
    values |= {"ways": float(len({each.label.removeprefix("agreement ").rsplit(" ", 3)[0] for each in others}))}
    text = (
        "{agree:.0f} of {of:.0f} other solves of the pressed tyre, by {ways:.0f} algorithms and settings, have the "
        "contact set of `semismooth` node by node; forces differ by at most {off:.0e} of their value."
    )
    scope = "the exact condition, where both end, on the paper's tyre; a finite ε solves other equations"
    yield Statement("algorithms-agree", "algorithms", text, values, len(pairs), scope, OPENING)


def _case(answer: Answer) -> tuple[str, ...]:
    return tuple(str(answer.settings[key]) for key in CASE)


def _unlike(answer: Answer, other: Answer) -> tuple[float, int]:
    """The largest relative difference of forces, and of nodes in contact in one only, over the travels of both."""
    forces = [{step["delta_mm"]: step["force_N"] for step in each.steps} for each in (answer, other)]
    common = [delta for delta in forces[0] if delta in forces[1]]
    off = max((abs(forces[0][delta] / forces[1][delta] - 1) for delta in common), default=math.inf)
    tables = [each.table("contact") for each in (answer, other)]
    sets = [table[table["delta_mm"].isin(common)]["active"].to_numpy() for table in tables]
    return off, int(np.sum(sets[0] != sets[1])) if len(sets[0]) == len(sets[1]) else -1


MAKERS = (algorithms_agree,)
