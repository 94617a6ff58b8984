"""Forms that are derived from a step: their answers follow from its own, built in beforehand."""

from __future__ import annotations

from pathlib import Path as File

import numpy as np

from contact.verify import judge
from studies.arena.answers import accuracy
from studies.arena.collected.candidates import (
    Path,
    condensed,
    of_complementarity,
    on_path,
    paths,
    published,
    raised,
    touching,
)
from studies.arena.collected.certified import Certified, find
from studies.arena.collected.formats import read_lcp
from support.problems.contact_problems import known_step, lopsided

OBSTACLE = 1e-9


def answer_of(du: np.ndarray, pressure: np.ndarray) -> Certified:
    """The built-in answer."""
    return Certified(du, pressure, "built in", pressure > 0, np.zeros(len(pressure), dtype=bool))


def test_the_dual_is_solved_by_the_forces() -> None:
    """Its pressures are the gaps of the step."""
    for step in (known_step()[0], lopsided(known_step()[0])):
        dual = condensed(step)
        inverse = np.linalg.inv(step.K.toarray())
        G = step.G.toarray()
        assert np.allclose(dual.K.toarray(), G @ inverse @ G.T, rtol=1e-10)
        assert np.allclose(dual.r, step.gap - G @ inverse @ step.r, rtol=1e-10)
    step, du, pressure = known_step()
    dual = condensed(step)
    gap = np.maximum(step.gap + step.G @ du, 0)
    assert accuracy(dual, step.weights * pressure, gap).worst <= 1e-12


def test_raised_foundations_touch_and_carry_nothing() -> None:
    """The answer stays one, and more candidates than before are closed without pressure."""
    step, du, pressure = known_step()
    states = raised(answer_of(du, pressure))
    assert states is not None
    lifted = touching(step, states)
    assert not judge(lifted.problem(), du, pressure).failures()
    closed = [np.sum((np.abs(s.gap + s.G @ du) <= OBSTACLE) & (pressure == 0)) for s in (step, lifted)]
    assert closed[1] > closed[0]


def test_nothing_is_raised_where_nothing_is_open() -> None:
    _, du, pressure = known_step(states=np.array([1, 1, 1, 1, 1, 1]))
    assert raised(answer_of(du, pressure)) is None


def test_published_problems_of_siconos_are_those_of_its_files(tmp_path: File) -> None:
    """The example of remark 4.1.14 of Cottle, Pang, Stone, as the file has it."""
    (tmp_path / "a.dat").write_text("2\n0\n2\n2\n2\t2\n1 1\n1 1\n-1 -1\n\nRemark\n", encoding="utf-8")
    ours = {candidate.name: candidate for candidate in published() if candidate.family == "siconos"}
    step = of_complementarity(*read_lcp(tmp_path / "a.dat"))
    kept = ours["siconos-CPS-1"]
    assert np.array_equal(kept.step.K.toarray(), step.K.toarray())
    assert np.array_equal(kept.step.r, step.r)
    assert kept.licence == "Apache-2.0"
    assert len(ours) == 17


def test_iterates_of_a_path_are_problems_of_its_solves() -> None:
    """Each solve begins with iteration 0, from where its step moves far; the last one hardly moves."""
    iterates = list(on_path(Path("strip-contact", "4x1", {"lam_over_a": "0.1"})))
    assert len(iterates) > 3
    assert all(candidate.family == "strip-contact" for candidate in iterates)
    assert len({candidate.name for candidate in iterates}) == len(iterates)
    last = [c for c in iterates if c.origin["solve"] == iterates[-1].origin["solve"]]
    assert last[0].origin["iteration"] == 0
    moved = [float(np.max(np.abs(find(c.step).du))) for c in (last[0], last[-1])]
    assert moved[1] < 1e-3 * moved[0]
    # few looks are the first and the last that moves
    few = list(on_path(Path("strip-contact", "4x1", {"lam_over_a": "0.1"}, looks=2)))
    solve = few[-1].origin["solve"]
    count = sum(c.origin["solve"] == solve for c in iterates)
    assert [c.origin["iteration"] for c in few if c.origin["solve"] == solve] == sorted({0, count - 2})


def test_paths_have_names_of_their_own() -> None:
    names = [path.name for path in paths()]
    assert len(names) == len(set(names)) > 100


def test_classics_have_their_published_answers() -> None:
    """Murty: z = (1, 0, ..., 0) in his order; here from his matrix alone: pressed is what M z + q says."""
    steps = {c.name: c.step for c in published()}
    for n in (3, 10):
        step, z = steps[f"Murty-{n}"], np.eye(n)[0]
        assert np.all(step.K @ z + step.r >= 0)
        assert z @ (step.K @ z + step.r) == 0
