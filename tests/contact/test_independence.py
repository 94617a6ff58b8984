"""Who judges or confirms an answer shares no line with who has found it; Newton with friction names no algorithm."""

from __future__ import annotations

from graphlib import TopologicalSorter
from itertools import product

import numpy as np
import pytest

from contact import rounding
from contact.verify import Verdict
from studies.run.source_hash import closure
from tests.test_imports import FILES, ROOT, graph_of

SEARCHES = ("contact.newton", "contact.algorithms", "contact.continuation", "contact.rounding")
JUDGES = {"contact.verify", "contact.verify_friction", "contact.balances"}


def test_the_judge_and_what_is_judged_reach_nothing_of_each_other() -> None:
    """Not even what is excused as rounding: an algorithm takes none of the judge's bounds for its own."""
    reached = closure(["contact.verify"])
    assert reached > JUDGES
    assert [name for name in reached if name.startswith(SEARCHES)] == []
    assert not closure(["contact.catalogue", "contact.continuation.load_stepping"]) & JUDGES


def test_the_judge_admits_what_an_algorithm_takes_for_rounding() -> None:
    sizes = [0.0, *10.0 ** np.arange(-12.0, -2.0)]
    for residual, known, correction in product(sizes, sizes, (0.0, 1e-10, 1e-8, np.inf)):
        verdict = Verdict(residual, 0.0, 0.0, 0.0, known, correction)
        assert verdict.excused or not rounding.excused(residual, known, correction)
    for tolerance, push, known in product((1e-9, 1e-8), (0.0, 1e-7, 1e-3), sizes):
        verdict = Verdict(0.0, 0.0, 0.0, 0.0, known, push=push)
        assert verdict.needed(tolerance) >= rounding.met(tolerance, push, known)


@pytest.mark.parametrize("name", ["oracle", "friction_oracle", "friction_states"])
def test_an_oracle_solves_by_no_solver_of_ours(name: str) -> None:
    source = (ROOT / f"contact/interchange/{name}.py").read_text(encoding="utf-8")
    assert not [word for word in ("factorise", "checked_solve", "multifrontal") if word in source]


def test_newton_with_friction_names_no_algorithm() -> None:
    reached = closure(["contact.newton.friction_run", "contact.newton.friction_loop"])
    assert not [name for name in reached if name.startswith("contact.algorithms")]


def test_no_two_modules_of_contact_need_each_other_even_for_types() -> None:
    sources = {file: (ROOT / file).read_text(encoding="utf-8") for file in FILES if file.startswith("contact/")}
    everything = {file: source.replace("if TYPE_CHECKING", "if True") for file, source in sources.items()}
    TopologicalSorter(graph_of(everything)).prepare()
