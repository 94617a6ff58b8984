"""What the tables of friction come to: ends, orders and sums by algorithm of made-up tables with known answers.

Sentences on friction: each is held against a table in which it is true, and changes where it would be false.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest

from reports.formats import Line
from studies.analysis.everything import DECLARED, fitted
from studies.analysis.friction import COST_BARS, by_algorithm, ends, orders, step_orders
from studies.experiments.friction.bars import capstan_table
from support.sentences import said
from support.stores.friction import (
    DRAGS,
    LOST,
    NAIVE,
    SOFT,
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

FAMILIES = DECLARED["friction_orders"]


def test_a_drag_is_full_from_where_it_stays_within_a_hundredth_of_its_bound() -> None:
    actual = ends(moved("drag_mm", DRAGS), "drag_mm")
    assert list(actual["full"]) == [8.0, 8.0]  # 0.98 of the bound is not enough
    assert list(actual["loose"]) == [8.0, 8.0]
    assert list(actual["off"]) == [0.0, 0.0]
    assert list(actual["largest"]) == [250.0, 500.0]
    assert list(actual["certified"]) == [4, 4]
    assert actual["command"][1].endswith("--set mu=0.5 --set drag_mm=1,2,8 --set drag_deg=90 --out DIR")


def test_a_turn_is_measured_by_the_chord_of_its_last_step() -> None:
    """The last step is of 10 degrees; whoever sticks in the centre sticks for ever."""
    actual = ends(moved("turn_deg", TURNS), "turn_deg")
    np.testing.assert_allclose(actual["off"], 0.0, atol=1e-15)
    assert list(actual["loose"]) == [2.0, 2.0]
    assert "drag_deg" not in actual["command"][0]


def test_what_does_not_hold_at_the_end_holds_from_nowhere() -> None:
    table = moved("drag_mm", DRAGS)
    table.loc[table["drag_mm"] == 8.0, ["friction_N", "sticking"]] = (100.0, 1)
    table.loc[1, "failures"] = "cone"
    actual = ends(table, "drag_mm")
    assert actual["full"].isna().all()
    assert actual["loose"].isna().all()
    assert list(actual["certified"]) == [3, 4]


def test_orders_are_those_that_errors_were_made_with() -> None:
    table = orders("strip", made_up_friction()["friction_strip"], **FAMILIES["strip"]).set_index("quantity")
    assert table["order"].drop("front").round(9).to_dict() == {"end": 2.0, "back": 2.0, "loop": 2.0, "counted": 1.0}
    assert math.isnan(table.loc["front", "order"])  # rounding
    assert table.loc["end", "error"] == pytest.approx(0.1 / 80**2)


def test_an_error_below_the_floor_on_one_mesh_has_no_order() -> None:
    table = made_up_friction()["friction_path"]
    table.loc[2, "end_error"] = 1e-9
    actual = orders("path", table, **FAMILIES["path"]).set_index("quantity")["order"]
    assert math.isnan(actual["end"])
    assert actual["work"] == pytest.approx(1.0)


def test_families_name_columns_that_the_experiments_make() -> None:
    table = capstan_table(((0.2, 1.0),), (4, 8), ("on",))
    actual = orders("capstan", table, **FAMILIES["capstan"])
    assert actual["order"][0] == pytest.approx(2.0, abs=0.2)
    made = made_up_friction()
    for name, of in FAMILIES.items():
        assert {*of["cases"], of["of"], *of["theory"]} - {"front_error"} <= set(made[f"friction_{name}"])


def test_the_order_of_steps_needs_no_limit() -> None:
    actual = step_orders(steps().drop(columns="cpu_s"))
    np.testing.assert_allclose(actual["order"], 1.0)
    assert list(actual["first_error"]) == [-0.04, 1.0]
    shifted = steps().assign(friction_N=lambda t: t["friction_N"] + 7.0)
    np.testing.assert_allclose(step_orders(shifted)["order"], 1.0)


def test_failures_and_other_steps_are_counted_and_are_in_no_median() -> None:
    table = by_algorithm(agreement()).set_index("algorithm")
    counts = table.loc[NAIVE, ["cases", "solved", "failed", "agrees", "other_steps", "both"]]
    assert counts.tolist() == [3, 2, 1, 1, 1, 1]
    assert table.loc[NAIVE, "iterations_ratio"] == 3.0
    assert table.loc[SOFT, ["exact", "agrees"]].tolist() == [0, 0]
    assert table.loc["qp", "operations_ratio"] == 1.5
    refused = agreement()
    refused.loc[(refused["case"] == LOST) & (refused["algorithm"] == NAIVE), "outcome"] = "unsupported"
    assert by_algorithm(refused).set_index("algorithm").loc[NAIVE, ["refused", "failed"]].tolist() == [1, 0]


def test_tables_are_made_of_those_that_are_there() -> None:
    made = fitted(made_up_friction().get)
    assert set(made) == {
        *("friction_drag_ends", "friction_turn_ends", "friction_orders", "friction_step_orders", "friction_algorithms")
    }
    assert set(made["friction_orders"]["family"]) == set(FAMILIES)
    assert isinstance(made["friction_algorithms"], pd.DataFrame)


def text(name: str, **tables: pd.DataFrame) -> str:
    """The one sentence of this name; nothing where it is not said."""
    return " ".join(Line({}).filled(each.text, each.values) for each in said(name, **tables))


# --- the tyre ---------------------------------------------------------------------------------------------------


def limits(first: float = 8.0, last: float = 8.0, **changed: object) -> str:
    """Of a drag that is full from these stops on, where the last coefficient has other values."""
    drag = ends(moved("drag_mm", DRAGS), "drag_mm").assign(full=[first, last])
    drag.loc[1, list(changed)] = list(changed.values())
    turn = ends(moved("turn_deg", TURNS), "turn_deg")
    return text("friction-limits", friction_drag_ends=drag, friction_turn_ends=turn)


def test_the_limit_of_a_drag_and_of_a_turn() -> None:
    met = limits()
    assert "a drag of 8 mm across" in met
    assert "for μ = 0.25 and 0.5; it is within 1 % of that from 8 mm on" in met
    assert "After a turn of 12 degrees on the spot" in met
    assert "The judge certifies 16 of 16 loads." in met
    missed = limits(off=-0.2, certified=2, full=np.nan)
    assert "is μ F_n with a relative error of 2e-01" in missed
    assert "for μ = 0.5 it does not stay within 1 % of that" in missed
    assert "certifies 14 of 16 loads" in missed
    assert "from 2 to 4 mm on, later the larger μ. After a turn" in limits(2.0, 4.0)
    assert "from 2 to 4 mm on. After a turn" in limits(4.0, 2.0)


def test_who_sticks_and_what_is_left() -> None:
    whole = text("friction-patch", friction_patch=patch())
    assert "nodes in contact that stick are 3 of 9 once pressed, 3 of 9 at 1 mm and 3 of 9 at 0 mm" in whole
    assert "the plane still pulls with 9 N of at most 45 N" in whole
    assert "back at its start" not in text("friction-patch", friction_patch=patch()[lambda t: t["stop"] < 2])


def test_what_load_steps_change() -> None:
    actual = text("friction-steps", friction_step_orders=step_orders(steps()), friction_steps=steps())
    assert "the tyre on 14x14 elements has errors of -4.0 % in the force and +100 % in the dissipation" in actual
    assert "in 8 steps, at 8 times the operations, -0.50 % and +12.5 %" in actual
    assert "are 1.00 and 1.00; theory says 1" in actual


def test_symmetry_is_said_of_what_keeps_it_alone() -> None:
    both, kept, lost = (
        text("friction-symmetry", friction_symmetry=symmetry().assign(**changed))
        for changed in ({}, {"normal": 0.0, "friction": 1e-15}, {"normal": 0.1})
    )
    assert both.startswith("Pressed and turned, the tyre keeps its central symmetry to 3e-14")
    assert "dragged, it does not: forces differ by up to 50 %" in both
    assert "does not" not in kept
    assert lost.startswith("Pressed, turned and dragged, it does not")


def test_steps_above_what_is_required_are_named() -> None:
    rules, below = pd.DataFrame([COST_BARS]), cost().assign(factorisations=1.0, operations_ratio=2.0)
    actual = text("friction-cost", friction_cost=cost(), rules=rules)
    assert "2.00 to 3.00 times the operations of one without, and 1.20 to 1.50 factorisations" in actual
    assert "limits set here are 2.5 and 1.2, and 1 of 2 steps exceed one of them: drag to 0.5 mm on 42x40." in actual
    assert "and none of 2 steps exceeds them." in text("friction-cost", friction_cost=below, rules=rules)
    assert "1.50 to 2.00 times one without" in text("friction-seconds", friction_cost=cost())


# --- the algorithms ---------------------------------------------------------------------------------------------


def test_who_agrees_and_who_does_not() -> None:
    actual = text("friction-agreement", friction_algorithms=by_algorithm(agreement()))
    assert actual.startswith("`semismooth` converges on 3 of 3 scenes with friction; so do `qp`, with every node")
    assert actual.endswith("; `trial-and-error` converges on 2 and agrees on 1.")
    off = agreement()
    off.loc[(off["algorithm"] == "qp") & (off["case"] == LOST), "agrees"] = 0
    actual = text("friction-agreement", friction_algorithms=by_algorithm(off))
    assert "so do" not in actual
    assert "`qp` converges on 3 and agrees on 2" in actual


def test_failures_and_other_paths_are_named() -> None:
    (lost,) = said("friction-fails-<algorithm>", friction_agreement=agreement())
    assert (lost.name, lost.role, lost.problems) == (f"friction-fails-{NAIVE}", "limitation", 3)
    failed = text("friction-fails-<algorithm>", friction_agreement=agreement())
    assert failed == "`trial-and-error` does not converge on 1 of 3 scenes with friction: 'tyre dragged'."
    other = text("friction-other-steps", friction_agreement=agreement())
    assert "1 of 11 converged solves took other load steps" in other
    assert "`trial-and-error` on 'ring' needed 8 instead of 2, and its forces differ by 25 % of the largest." in other
    fine = agreement()[lambda t: t["algorithm"] != NAIVE]
    for name in ("friction-fails-<algorithm>", "friction-other-steps"):
        assert text(name, friction_agreement=fine) == ""


def test_what_springs_change() -> None:
    actual = text("friction-regularised", friction_agreement=agreement())
    assert "springs of 10000 MPa/mm changes nodal forces by 1e-04 to 1e-04 of the largest on 3 scenes" in actual
    assert (
        "; with twice the elements in each direction by 2e-04 to 2e-04 on 2; on 1 the two take different load steps"
        in actual
    )
    assert text("friction-regularised", friction_agreement=agreement().assign(epsilon=np.inf)) == ""


def test_the_plate_and_who_fails_on_it() -> None:
    actual = text("friction-greco", friction_greco=greco())
    assert "2 of 3 algorithms converge, with errors of the slips of at most 0.010 % on 16x16" in actual
    assert actual.endswith("; `trial-and-error` (cycling) fails.")
    fine = greco()[lambda t: t["algorithm"] != NAIVE]
    assert text("friction-greco", friction_greco=fine).endswith("16x16 elements.")


def test_answers_of_springs_are_counted_by_how_many_there_are() -> None:
    actual = text("friction-klarbring", friction_klarbring=klarbring())
    assert "Of 3 sets of Klarbring's springs 1 have one answer, 1 several and 1 none" in actual
    assert "in 2 of 3 solves and one of several in 3 of 3; where there is none they claim 0 of 3" in actual
    wrong = klarbring()
    wrong.loc[wrong["case"] == "nothing", ["outcome", "found"]] = ("converged", "wrong")
    assert "they claim 3 of 3, and 3 claims are wrong" in text("friction-klarbring", friction_klarbring=wrong)


def test_orders_beside_theory() -> None:
    made = fitted(made_up_friction().get)["friction_orders"]
    actual = text("friction-orders", friction_orders=made)
    assert "1 are below 1e-08, 3 fall with orders from 1.00 to 1.00 where theory says 1" in actual
    assert "11 fall with orders from 2.00 to 2.00 where theory says 2" in actual
    made.loc[made["quantity"] == "moment", "order"] = 0.5
    assert "orders from 0.50 to 2.00 where theory says 2" in text("friction-orders", friction_orders=made)


def test_tied_nodes_and_motions() -> None:
    actual = text("friction-tied", friction_tied=tied())
    assert "1 of 2 cases have an answer" in actual
    assert (
        "`semismooth` finds 1 of them, to 1e-15 of the displacements, and claims one in 0 of the 1 without." in actual
    )
    false = tied().assign(outcome="converged", otherwise=1.0)
    assert "finds 0 of them, and claims one in 1 of the 1" in text("friction-tied", friction_tied=false)
    actual = text("friction-motions", friction_joint_motion=joint_motion(), friction_rolling=rolling())
    assert "up to 500 mm and 3 rad keeps its friction, 13.5 N, to 1e-11 N and dissipates 1e-13" in actual
    assert "hub in the middle to 1e-14 mm, and rolls on the radius of its bars to 1.0e-06" in actual


def test_what_friction_adds_to_the_ring() -> None:
    """The state that nobody else has is not in it."""
    actual = text("friction-crushed-ring", friction_crushed_ring=crushed())
    assert "μ = 0.4 adds +1.00 % to +2.00 % on `crushed-ring`, over 2 states" in actual
    assert "Code_Aster gives +2.00 % to +4.00 %" in actual
    assert "refuses" not in actual
    refused = crushed().assign(failures=["", "cone", ""]).replace("", None)
    actual = text("friction-crushed-ring", friction_crushed_ring=refused)
    assert actual.endswith("The judge refuses 1 of these states.")


@pytest.mark.parametrize("refused", [0, 1])
def test_public_problems_and_refused_claims(refused: int) -> None:
    table = public()
    table.loc[3, "certified"] = not refused
    actual = text("friction-public", friction_public=table)
    assert f"Of 2 public problems of Siconos {2 - refused} have an answer that the judge accepts" in actual
    assert f"Claimed answers refused by the judge: {refused}." in actual
