"""Who judges or confirms an answer shares no line with who has found it; Newton with friction names no algorithm."""

from __future__ import annotations

from fnmatch import fnmatchcase

import pytest

from studies.run.store.source_hash import closure
from tests.test_imports import ROOT

FOUND_BY = ("contact.newton*", "contact.algorithms*", "contact.continuation*", "contact.friction.[hlrc]*", "*.step")


def test_the_judge_reaches_no_algorithm_and_nothing_of_newton() -> None:
    """Nor does Newton ask the judge: what an imbalance still asks for each works out by itself."""
    reached = closure(["contact.verify"])
    assert {"contact.rounding", "contact.friction.verify"} <= reached
    assert not [name for name in reached if any(fnmatchcase(name, each) for each in FOUND_BY)]
    assert "contact.verify" not in closure(["contact.newton.loop", "contact.friction.loop"])


@pytest.mark.parametrize("name", ["oracle", "friction_oracle", "friction_states"])
def test_an_oracle_solves_by_no_solver_of_ours(name: str) -> None:
    source = (ROOT / f"contact/interchange/{name}.py").read_text(encoding="utf-8")
    assert not [word for word in ("factorise", "checked_solve", "multifrontal") if word in source]


def test_newton_with_friction_names_no_algorithm() -> None:
    reached = closure(["contact.friction.run", "contact.friction.loop"])
    assert not [name for name in reached if name.startswith("contact.algorithms")]
