"""The public problems: the shipped table against itself, and the small ones again."""

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
)


def test_the_shipped_table_is_what_its_module_tells() -> None:
    """Every problem by all, who is not tried with a reason; whoever claims an answer by the exact law is certified."""
    found = public_table()
    tried, gone = found[found["outcome"] != UNDECIDED], found[found["outcome"] == UNDECIDED]
    taken = found[found["certified"] == "True"]
    assert (found["problem"].nunique(), tried["problem"].nunique(), taken["problem"].nunique()) == (65, 62, 56)
    assert taken["algorithm"].value_counts().to_dict() == {
        **{"augmented-lagrangian": 45, "lcp": 42, ORACLE: 43, "semismooth": 46, "qp": 26, "trial-and-error": 18}
    }
    assert set(taken.loc[taken["algorithm"] != ORACLE, "agrees"]) == {"True", ""}
    assert (gone["reason"] != "").all()
    assert not set(gone["problem"]) & set(tried["problem"])
    assert set(tried.groupby("problem")["algorithm"].agg(tuple)) == {(ORACLE, *algorithms())}
    claims = found[(found["outcome"] == "converged") & ~found["reason"].str.startswith("by its own law")]
    assert len(claims) > 200
    assert (claims["certified"] == "True").all()
    own = found[found["algorithm"] == ORACLE]
    assert (own.loc[own["certified"] != "True", "reason"] != "").all()


@pytest.mark.slow
@pytest.mark.parametrize("names", [slice(0, None, 2), pytest.param(slice(1, None, 2), marks=pytest.mark.slow)])
def test_small_problems_come_out_as_in_the_table(names: slice) -> None:
    kept = public_table().set_index(["problem", "algorithm"])
    for name, problem in list(small().items())[names]:
        for row in rows(name, problem, 60.0):
            for column in ("outcome", "certified", "agrees"):
                assert str(row[column]) == str(kept.loc[(name, row["algorithm"]), column]), (name, row)


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


def test_a_solve_that_does_not_end_stops_nothing() -> None:
    def endless() -> Tried:
        while True:
            pass

    found = limited(endless, 0.1)
    assert (found.outcome, found.reason) == ("time limit", "more than 0.1 s")
    assert limited(lambda: Tried("none"), 0.1).outcome == "none"


def test_files_that_are_none_are_told(tmp_path) -> None:
    (tmp_path / "none.dat").write_text("0 0 0")
    (tmp_path / "none.hdf5").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises((SiconosError, OSError)):
        read_any(tmp_path / "none.hdf5")
    (tmp_path / "none.hdf5").unlink()
    found = table([tmp_path])
    assert found["outcome"].tolist() == [UNDECIDED]
    assert "the file is no frictional problem" in found["reason"][0]
