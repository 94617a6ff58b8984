"""The public problems: the shipped table against itself, and the small ones again."""

from __future__ import annotations

import os
from functools import partial

import numpy as np
import pytest

from contact.coulomb import State
from contact.interchange.friction_oracle import minimise
from contact.interchange.siconos import SiconosError
from studies.experiments.friction.public_problems import (
    ORACLE,
    UNDECIDED,
    Tried,
    algorithms,
    limited,
    public_table,
    read_any,
    rows,
    small,
    table,
    timed,
)


def test_at_least_sixty_problems_were_tried() -> None:
    found = public_table()
    tried = found[found["outcome"] != UNDECIDED]
    assert tried["problem"].nunique() >= 60
    gone = found[found["outcome"] == UNDECIDED]
    assert (gone["reason"] != "").all()
    assert not set(gone["problem"]) & set(tried["problem"])
    each = tried.groupby("problem")["algorithm"].agg(list)
    assert all(sorted(names) == sorted(each.iloc[0]) for names in each)


def test_the_sums_are_those_that_are_told() -> None:
    found = public_table()
    tried, taken = found[found["outcome"] != UNDECIDED], found[found["certified"] == "True"]
    assert (found["problem"].nunique(), tried["problem"].nunique(), taken["problem"].nunique()) == (65, 62, 56)
    assert taken["algorithm"].value_counts().to_dict() == {
        "augmented-lagrangian": 45,
        "lcp": 42,
        ORACLE: 43,
        "semismooth": 46,
        "qp": 26,
        "trial-and-error": 18,
    }
    assert set(taken.loc[taken["algorithm"] != ORACLE, "agrees"]) == {"True", ""}


def test_no_claim_is_false() -> None:
    """Whoever says converged by the exact law is taken by the judge."""
    found = public_table()
    claims = found[(found["outcome"] == "converged") & ~found["reason"].str.startswith("by its own law")]
    assert len(claims) > 200
    assert (claims["certified"] == "True").all()


def test_the_oracle_has_most() -> None:
    found = public_table()
    own = found[found["algorithm"] == ORACLE]
    assert (own["certified"] == "True").sum() >= 40
    assert (own.loc[own["certified"] != "True", "reason"] != "").all()


@pytest.mark.parametrize("name", small())
def test_small_problems_come_out_as_in_the_table(name: str) -> None:
    kept = public_table().query("problem == @name").set_index("algorithm")
    found = {str(row["algorithm"]): row for row in rows(name, small()[name], timed)}
    assert set(found) == {ORACLE, *algorithms()}
    for algorithm, row in found.items():
        for column in ("outcome", "certified", "agrees"):
            assert str(row[column]) == str(kept.loc[algorithm, column]), (algorithm, column)


def test_one_contact_by_hand() -> None:
    """W = 1, q = (-1, 1, 3), mu = 0.1 of FrictionContact3D_1c: f = 1, slip along (1, 3), friction against it."""
    problem = small()["FrictionContact3D_1c.dat"]
    assert problem.W is not None
    found = minimise(problem.step())
    f = found.normal[0]
    direction = found.friction[0] / np.linalg.norm(found.friction[0])
    ways = problem.W @ np.array([f, *found.friction[0]]) + problem.offset
    assert found.state.tolist() == [State.SLIP]
    assert ways[0] == pytest.approx(0, abs=1e-12)
    assert np.linalg.norm(found.friction[0]) == pytest.approx(problem.mu[0] * f, rel=1e-12)
    assert direction @ ways[1:] == pytest.approx(-np.linalg.norm(ways[1:]), rel=1e-12)


def test_a_solve_is_ended_after_its_time() -> None:
    def endless() -> Tried:
        while True:
            pass

    found = limited(endless, 1.0)
    assert (found.outcome, found.reason) == ("time limit", "more than 1 s")


def test_a_solve_that_dies_stops_nothing() -> None:
    found = limited(partial(os._exit, 3), 5.0)
    assert (found.outcome, found.reason) == ("died", "exit code 3")


def test_files_that_are_none_are_told(tmp_path) -> None:
    (tmp_path / "none.dat").write_text("0 0 0")
    (tmp_path / "none.hdf5").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises((SiconosError, OSError)):
        read_any(tmp_path / "none.hdf5")
    (tmp_path / "none.hdf5").unlink()
    found = table([tmp_path])
    assert found["outcome"].tolist() == [UNDECIDED]
    assert "the file is no frictional problem" in found["reason"][0]
