"""Sentences on friction: each is held against a table in which it is true, and changes where it would be false."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pandas as pd
import pytest

from reports.formats import Line
from studies.analysis.friction import COST_BARS, FAMILIES, by_algorithm, ends, orders, step_orders
from studies.analysis.statements import friction
from studies.analysis.statements.record import LIMIT, OPENING, Statement
from support.sentences import said
from support.stores.friction import (
    DRAGS,
    LOST,
    NAIVE,
    TURNS,
    agreement,
    cost,
    crushed,
    greco,
    joint_motion,
    klarbring,
    made_up_friction,
    moved,
    patch,
    public,
    rolling,
    steps,
    symmetry,
    tied,
)


def texts(found: Iterable[Statement]) -> list[str]:
    return [Line({}).filled(each.text, each.values) for each in found]


# --- the tyre ---------------------------------------------------------------------------------------------------


def both() -> tuple[pd.DataFrame, pd.DataFrame]:
    return ends(moved("drag_mm", DRAGS), "drag_mm"), ends(moved("turn_deg", TURNS), "turn_deg")


def test_the_limit_of_a_drag_and_of_a_turn() -> None:
    drag, turn = both()
    (opening,) = friction.limits(drag, turn)
    assert (opening.role, opening.page, opening.problems) == (OPENING, "friction", 16)
    (text,) = texts(iter([opening]))
    assert "dragged across by 8 mm" in text
    assert "for μ = 0.25 and 0.5; it is within 1 % of that from 8 mm on" in text
    assert "Turned on the spot by 12 degrees" in text
    assert "The judge certifies 16 of 16 loads." in text


def test_a_limit_that_is_not_met_is_not_said_to_be() -> None:
    drag, turn = both()
    drag.loc[1, ["full", "off", "certified"]] = (np.nan, -0.2, 2)
    (text,) = texts(friction.limits(drag, turn))
    assert "by μ F_n with a relative error of 2e-01" in text
    assert "for μ = 0.5 it does not stay within 1 % of that" in text
    assert "certifies 14 of 16 loads" in text


def test_stops_in_another_order_of_coefficients_are_not_said_to_rise() -> None:
    drag, turn = both()
    drag["full"] = [2.0, 4.0]
    assert "from 2 to 4 mm on, later the larger μ. Turned" in texts(friction.limits(drag, turn))[0]
    drag["full"] = [4.0, 2.0]
    assert "from 2 to 4 mm on. Turned" in texts(friction.limits(drag, turn))[0]


def test_who_sticks_and_what_is_left() -> None:
    (text,) = texts(friction.patch(patch()))
    assert "the nodes in contact that stick are 3 of 9 once it is pressed, 3 of 9 at 1 mm and 3 of 9 at 0 mm" in text
    assert "the plane still pulls with 9 N of at most 45 N" in text
    (text,) = texts(friction.patch(patch()[lambda t: t["stop"] < 2]))
    assert "back at its start" not in text


def test_what_load_steps_change() -> None:
    (found,) = said("friction-steps", friction_step_orders=step_orders(steps()), friction_steps=steps())
    assert found.role == LIMIT
    (text,) = texts(iter([found]))
    assert "in 1 step each the tyre has errors of -4.0 % in its force and +100 % in its dissipation" in text
    assert "in 8 steps, at 8 times the operations, -0.50 % and +12.5 %" in text
    assert "are 1.00 and 1.00; theory says 1" in text


def test_symmetry_is_said_of_what_keeps_it_alone() -> None:
    (text,) = texts(friction.symmetry(symmetry()))
    assert text.startswith("Pressed and turned, the tyre keeps its central symmetry to 3e-14")
    assert "dragged, it does not: forces differ by up to 50 %" in text
    whole = symmetry().assign(normal=0.0, friction=1e-15)
    assert "does not" not in texts(friction.symmetry(whole))[0]
    lost = symmetry().assign(normal=0.1)
    assert texts(friction.symmetry(lost))[0].startswith("Pressed, turned and dragged, it does not")


def test_steps_above_what_is_required_are_named() -> None:
    rules = pd.DataFrame([COST_BARS])
    (text,) = texts(said("friction-cost", friction_cost=cost(), rules=rules))
    (seconds,) = texts(said("friction-seconds", friction_cost=cost()))
    assert "2.00 to 3.00 times the operations of one without, and 1.20 to 1.50 factorisations" in text
    assert "required are at most 2.5 and 1.2, and 1 of 2 steps exceed one of them: drag to 0.5 mm on 42x40." in text
    assert "1.50 to 2.00 times one without" in seconds
    below = cost().assign(factorisations=1.0, operations_ratio=2.0)
    assert "and none of 2 steps exceeds them." in texts(said("friction-cost", friction_cost=below, rules=rules))[0]


# --- the algorithms ---------------------------------------------------------------------------------------------


def test_who_agrees_and_who_does_not() -> None:
    (opening,) = said("friction-agreement", friction_algorithms=by_algorithm(agreement()))
    (text,) = texts(iter([opening]))
    assert opening.role == OPENING
    assert text.startswith("`semismooth` converges on 3 of 3 scenes with friction; so do `qp`, with every node")
    assert text.endswith("; `trial-and-error` converges on 2 and agrees on 1.")
    off = agreement()
    off.loc[(off["algorithm"] == "qp") & (off["case"] == LOST), "agrees"] = 0
    (text,) = texts(said("friction-agreement", friction_algorithms=by_algorithm(off)))
    assert "so do" not in text
    assert "`qp` converges on 3 and agrees on 2" in text


def test_failures_and_other_paths_are_named() -> None:
    (lost,) = friction.failures(agreement())
    assert lost.role == LIMIT
    assert texts([lost]) == ["`trial-and-error` does not converge on 1 of 3 scenes with friction: 'tyre dragged'."]
    (text,) = texts(said("friction-other-steps", friction_agreement=agreement()))
    assert "1 of 11 converged solves took other load steps" in text
    assert "`trial-and-error` on 'ring' needed 8 instead of 2, and its forces differ by 25 % of the largest." in text
    fine = agreement()[lambda t: t["algorithm"] != NAIVE]
    assert [*friction.failures(fine), *said("friction-other-steps", friction_agreement=fine)] == []


def test_what_springs_change() -> None:
    (text,) = texts(said("friction-regularised", friction_agreement=agreement()))
    assert "springs of 10000 MPa/mm changes nodal forces by 1e-04 to 1e-04 of the largest on 3 scenes" in text
    assert "; on twice the elements each way by 2e-04 to 2e-04 on 2, while on 1 the two take other load steps" in text
    assert said("friction-regularised", friction_agreement=agreement().assign(epsilon=np.inf)) == []


def test_the_plate_and_who_fails_on_it() -> None:
    (text,) = texts(said("friction-greco", friction_greco=greco()))
    assert "2 of 3 algorithms converge, with errors of the slips of at most 0.010 % on 16x16" in text
    assert text.endswith("; `trial-and-error` (cycling) fails.")
    assert texts(said("friction-greco", friction_greco=greco()[lambda t: t["algorithm"] != NAIVE]))[0].endswith(
        "16x16 elements."
    )


def test_answers_of_springs_are_counted_by_how_many_there_are() -> None:
    (text,) = texts(said("friction-klarbring", friction_klarbring=klarbring()))
    assert "Of 3 sets of Klarbring's springs 1 have one answer, 1 several and 1 none" in text
    assert "in 2 of 3 solves and one of several in 3 of 3; where there is none they claim 0 of 3" in text
    wrong = klarbring()
    wrong.loc[wrong["case"] == "nothing", ["outcome", "found"]] = ("converged", "wrong")
    assert "they claim 3 of 3, and 3 claims are wrong" in texts(said("friction-klarbring", friction_klarbring=wrong))[0]


def test_orders_beside_theory() -> None:
    tables = made_up_friction()
    found = pd.concat([orders(name, tables[family.table]) for name, family in FAMILIES.items()])
    (text,) = texts(said("friction-orders", friction_orders=found))
    assert "1 are below 1e-08, 3 fall with orders from 1.00 to 1.00 where theory says 1" in text
    assert "11 fall with orders from 2.00 to 2.00 where theory says 2" in text
    found.loc[found["quantity"] == "moment", "order"] = 0.5
    assert "orders from 0.50 to 2.00 where theory says 2" in texts(said("friction-orders", friction_orders=found))[0]


def test_tied_nodes_and_motions() -> None:
    (text,) = texts(said("friction-tied", friction_tied=tied()))
    assert "1 of 2 cases have an answer" in text
    assert "`semismooth` finds 1 of them, to 1e-15 of the displacements, and claims one in 0 of the 1 without." in text
    false = tied().assign(outcome="converged", otherwise=1.0)
    assert "finds 0 of them, and claims one in 1 of the 1" in texts(said("friction-tied", friction_tied=false))[0]
    (text,) = texts(said("friction-motions", friction_joint_motion=joint_motion(), friction_rolling=rolling()))
    assert "up to 500 mm and 3 rad keeps its friction, 13.5 N, to 1e-11 N and dissipates 1e-13" in text
    assert "hub in the middle to 1e-14 mm, and rolls on the radius of its bars to 1.0e-06" in text


def test_what_friction_adds_to_the_ring() -> None:
    """The state that nobody else has is not in it."""
    (text,) = texts(said("friction-crushed-ring", friction_crushed_ring=crushed()))
    assert "μ = 0.4 adds +1.00 % to +2.00 % on `crushed-ring`, over 2 states" in text
    assert "Code_Aster finds +2.00 % to +4.00 %" in text
    assert "refuses" not in text
    refused = crushed().assign(failures=["", "cone", ""]).replace("", None)
    (text,) = texts(said("friction-crushed-ring", friction_crushed_ring=refused))
    assert text.endswith("The judge refuses 1 of these states.")


@pytest.mark.parametrize(("certified", "refused"), [(False, 1), (True, 0)])
def test_public_problems_and_refused_claims(certified: bool, refused: int) -> None:
    table = public()
    table.loc[3, "certified"] = certified
    (text,) = texts(friction.public(table))
    assert f"Of 2 public problems of Siconos {2 - refused} have an answer that the judge takes" in text
    assert f"Of what is claimed {refused} answers are refused by the judge." in text
