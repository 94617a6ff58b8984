"""Cards: a bad newcomer is found out, a slow right one passes with its price, and what cannot be tried says so."""

from __future__ import annotations

import math
import re
import signal
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution
from formulations.strains.catalogue import MEASURES
from reports.arena_pages import card_page
from studies.arena.card import card as card_module
from studies.arena.card import problems, runs
from studies.arena.card.card import Card, card_of
from studies.arena.card.laws import LAWS, laws_of
from studies.arena.card.problems import sample
from studies.arena.card.runs import ALGORITHM, CATALOGUES, ELEMENT, MEASURE, SOLVER, Subject, subjects
from studies.arena.card.trials import (
    DIFFERS,
    FAILED,
    FALSE,
    LATE,
    RAISED,
    REFUSED,
    SOLVED,
    alone,
    asked,
    epsilon_of,
    within,
)
from studies.arena.card.trials import OvertimeError as Overtime
from studies.cli import main
from studies.experiments.conformance import Check
from support.kinds import FILES
from support.sources import file_of

PARTS = Path(__file__).parent / "parts"


@pytest.fixture(autouse=True)
def put_back(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Catalogues, modules and the search path are left as they were."""
    every = [catalogue for catalogues in CATALOGUES.values() for catalogue in catalogues]
    known, loaded = [dict(catalogue) for catalogue in every], set(sys.modules)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield
    for catalogue, before in zip(every, known, strict=True):
        catalogue.clear()
        catalogue.update(before)
    own = {path.stem for path in (*PARTS.glob("*.py"), *FILES.values())} | {"my_algorithm", "nothing", "saddle"}
    for name in own & (set(sys.modules) - loaded):
        del sys.modules[name]


def part(name: str) -> Subject:
    (subject,) = subjects(str(PARTS / f"{name}.py"))
    return subject


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """A card on a few problems and beside one part of ours alone."""
    monkeypatch.setattr(runs, "posed", lambda epsilon: islice(problems.made(epsilon), 5))
    monkeypatch.setattr(runs, "SMALL", (problems.Asked("scene", "heavy-strip", "8x1"),))
    monkeypatch.setattr(runs, "POINTS", (problems.Asked("hard", "panel", "2x2", {}, "coarse"),))
    monkeypatch.setattr(runs, "BENT", (problems.Asked("scene", "cantilever", "2x1"),))
    monkeypatch.setattr(runs, "BESIDE", ("semismooth", "Lemke"))


def beside(subject: Subject, *ours: str) -> Subject:
    return Subject(subject.kind, subject.name, subject.file, ours)


# --- what a card says -------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_nodes_dropped_at_random_are_false_claims_that_are_named(few: None) -> None:
    card = card_of(beside(part("hasty"), "semismooth", "lcp"))
    false = card.ended(FALSE)
    assert len(false) >= 3
    assert not card.passes
    assert card.verdict.startswith("`hasty` FAILS: it solves ")
    assert f"false claim on {len(false)}" in card.verdict
    assert str(false["problem"].iloc[0]) in card.verdict
    assert {"answers are those of non-negative least squares", "the same question has the same answer"} <= {
        law.law for law in card.broken
    }
    text = card_page([card.told], "footprint card hasty.py", "1")
    assert all(name in text for name in false["problem"])


@pytest.mark.slow
def test_a_right_one_that_solves_twice_passes_and_costs_twice(few: None) -> None:
    card = card_of(beside(part("twice"), "semismooth", "lcp"))
    assert card.passes
    assert (card.own["ended"] == SOLVED).all()
    ratios = card.ratios()
    own = ratios.loc[ratios["who"] == "twice", "operations_ratio"]
    np.testing.assert_allclose(own, 2.0, rtol=1e-3)
    place = card.place().set_index("figure")
    assert place.loc["solved share", "rank"] == 1
    assert place.loc["operations", "best"] == 1.0
    assert "median **2.00**" in card_page([card.told], "footprint card twice.py", "1")


@pytest.mark.slow
def test_a_wrong_coefficient_of_a_measure_is_found(few: None) -> None:
    card = card_of(beside(part("slanted"), "exact"))
    assert not card.passes
    assert any("rigid motions" in law.law for law in card.broken)
    assert card.ended(FALSE).empty  # the state is one of this measure: it is the measure that is wrong


@pytest.mark.slow
def test_a_solver_that_claims_what_it_has_not_is_found(few: None) -> None:
    card = card_of(part("boastful"))
    assert len(card.ended(FALSE)) >= 2
    assert not card.passes
    others = card.tries[card.tries["who"] == "semismooth"]
    assert (others["ended"] == SOLVED).all()


@pytest.mark.slow
def test_an_element_option_is_solved_with_though_no_scene_knows_it(few: None) -> None:
    card = card_of(beside(part("halfway"), "balanced"))
    assert card.passes
    assert (card.own["away"].dropna() < 0.5).all()
    assert card.own["away"].max() > 0  # it is not the option of ours under another name


# --- verdicts ---------------------------------------------------------------------------------------------------------


def made_up(*ends: str, agreement: str = "agrees", laws: tuple[Check, ...] = (Check("a law", 0.0),)) -> Card:
    rows = []
    for i, ended in enumerate(ends):
        same = {"group": "made", "problem": f"problem {i}", "reason": "because", "iterations": 1.0}
        same |= {"factorisations": 1.0, "apart": 0.0, "away": math.nan}
        compared = agreement if ended == SOLVED else ""
        own = {"ended": ended, "operations": 30.0, "seconds": 0.3, "agreement": compared}
        ours = {"ended": SOLVED, "operations": 10.0, "seconds": 0.1, "agreement": ""}
        rows += [{**same, "who": "new", **own}, {**same, "who": "semismooth", **ours}]
    return Card(Subject(ALGORITHM, "new", "new.py", ("semismooth",)), laws, pd.DataFrame(rows))


def test_what_fails_a_card() -> None:
    """False claims, exceptions, differences and broken laws; not what is unsolved, late or refused."""
    for ended, passes in ((SOLVED, 1), (FAILED, 1), (LATE, 1), (REFUSED, 1), (FALSE, 0), (RAISED, 0)):
        card = made_up(SOLVED, ended)
        assert card.passes == bool(passes)
        assert card.verdict.startswith(f"`new` {'passes' if passes else 'FAILS'}: it solves ")
        assert f"of 2 problems{'' if ended == SOLVED else f', {ended} on 1'}" in card.verdict
    assert not made_up(SOLVED, agreement=DIFFERS).passes
    for kind, right in ((ALGORITHM, "the exact ones"), (MEASURE, "those of `lcp` with it")):
        card = made_up(SOLVED, agreement=DIFFERS)
        said = replace(card, subject=replace(card.subject, kind=kind)).verdict
        assert f", 1 of 1 answers differ from {right}; " in said
    assert made_up(SOLVED, agreement="within what the tolerance leaves").passes
    assert not made_up(SOLVED, laws=(Check("a law", 1.0),)).passes
    assert not made_up(SOLVED, laws=(Check("a law", math.nan),)).passes
    assert made_up(SOLVED, laws=(Check("a law", math.nan, refused="made for others"),)).passes


def test_failures_lower_the_place_and_refusals_do_not() -> None:
    shares = made_up(SOLVED, FAILED).place().set_index("figure")["value"]
    assert shares["solved share"] == 0.5
    assert shares["operations"] == 0.0  # three times the least
    refusing = made_up(SOLVED, REFUSED).place().set_index("figure")
    assert refusing.loc["solved share", "value"] == 1.0
    assert refusing.loc["solved share", "problems"] == 1


def test_operations_that_are_not_counted_are_not_known_and_no_lowest_price() -> None:
    """A solution by scipy counts none: of such problems nobody is the cheapest."""
    card = made_up(SOLVED, SOLVED, FAILED)
    card.tries.loc[(card.tries["who"] == "new") & (card.tries["problem"] == "problem 0"), "operations"] = 0.0
    place = card.place().set_index("figure")
    assert place.loc["operations", "value"] == 0.0  # three times the least, and unsolved
    assert place.loc["operations", "rank"] == 2
    assert place["problems"].to_dict() == {"solved share": 3, "operations": 2, "seconds": 3}
    assert "| operations | 2 of 2 | 2 |" in card_page([card.told], "footprint card new.py", "1")


def test_ratios_are_of_problems_that_both_solve_and_of_another_part_of_ours() -> None:
    card = made_up(SOLVED, FALSE, REFUSED)
    ratios = card.ratios()
    own = ratios[ratios["who"] == "new"]
    assert own["operations_ratio"].tolist()[:1] == [3.0]
    assert own["operations_ratio"].isna().tolist() == [False, True, True]
    assert card.reference == "semismooth"
    ours = Card(Subject(ALGORITHM, "semismooth", "", ("semismooth", "new")), card.laws, card.tries)
    assert ours.reference == "new"


def test_the_page_shows_every_failure_with_its_reason() -> None:
    text = card_page([made_up(SOLVED, FALSE, FAILED, REFUSED).told], "footprint card new.py", "1", "card-new.svg")
    assert text.count("because") == 3
    assert "![Cost over that of semismooth, problem by problem](card-new.svg)" in text
    assert text.index("**`new` FAILS") < text.index("## Problems")
    assert len({line.count("|") for line in text.partition("## Laws")[2].partition("##")[0].splitlines() if line}) == 1


# --- laws and tries ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ALGORITHMS)
def test_the_algorithms_of_the_suite_keep_every_law(name: str) -> None:
    laws = list(laws_of(name))
    assert len(laws) == len(LAWS)
    assert [law for law in laws if not law.passed or law.refused] == []


def test_parameters_of_what_is_no_dataclass_break_their_law() -> None:
    class Plain:
        """Keeps its parameters in its own way."""

        parameters = Semismooth.parameters

    ALGORITHMS["plain"] = Plain
    first = next(laws_of("plain"))
    assert (first.law, first.said) == (LAWS[0][0], "no dataclass")
    assert not first.passed


class EmptySet(Semismooth):
    """Forgets which nodes press."""

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        found = super().solve(problem, start)
        return replace(found, active=np.zeros_like(found.active))


class Doubled(Semismooth):
    """Leaves a stiffness behind that is not that of the body."""

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        found = super().solve(problem, start)
        problem.linearise(start.u, None).tangent.data[:] *= 2
        return found


@pytest.mark.parametrize(
    ("kind", "broken"),
    [
        (EmptySet, ["the set is that of the nodes that press"]),
        (Doubled, ["the start and the problem are left as they were"]),
    ],
)
def test_what_no_answer_shows_is_a_law_that_is_broken(kind: type[Semismooth], broken: list[str]) -> None:
    ALGORITHMS["semismooth"] = kind
    assert [law.law for law in laws_of("semismooth") if not law.passed] == broken


@pytest.mark.parametrize("breaks", [SystemExit(0), ValueError("one\ntwo"), None])
def test_a_measure_that_breaks_has_a_card_that_says_so(
    breaks: BaseException | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = MEASURES["exact"]

    class Odd:
        name = "odd"

        def __getattr__(self, key: str) -> object:
            return getattr(exact, key)

        def strain(self, *a: object) -> np.ndarray:
            if breaks is not None:
                raise breaks
            return np.nan * exact.strain(*a)

    MEASURES["odd"] = Odd()
    monkeypatch.setattr(card_module, "ELEMENTS", card_module.ELEMENTS[:1])
    broken = [law for law in card_module._kit(Subject(MEASURE, "odd", "", ("exact",))) if not law.passed]
    assert broken
    assert all("\n" not in law.said for law in broken)


BAD_SOLVER = """from dataclasses import dataclass
import numpy as np
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.catalogue import SOLVERS
@dataclass(frozen=True)
class Bad(Solver):
    def applies(self, step):
        return {applies}
    def answer(self, step, tolerance):
        return Answer(np.zeros(1), [0.0], True)
SOLVERS["bad"] = Bad("bad")
"""


@pytest.mark.parametrize(
    "applies", ["exit()", *(pytest.param(each, marks=pytest.mark.slow) for each in ("None", "1 / 0"))]
)
def test_a_solver_with_no_answer_has_a_card_of_exceptions(applies: str, few: None, tmp_path: Path) -> None:
    path = tmp_path / f"nothing{len(applies)}.py"
    path.write_text(BAD_SOLVER.replace("{applies}", applies))
    card = card_of(*subjects(str(path)))
    assert (card.own["ended"] == RAISED).all()
    assert card.broken


def test_who_refuses_every_problem_has_no_place(few: None) -> None:
    class Never(Semismooth):
        def supports(self, problem: ContactProblem) -> str:
            return "not today"

    ALGORITHMS["never"] = Never
    card = card_of(Subject(ALGORITHM, "never", "", ("semismooth",)))
    assert (card.own["ended"] == REFUSED).all()
    assert "it solves 0 of 7 problems, refused on 7" in card_page([card.told], "footprint card never.py", "1")


def test_an_algorithm_that_takes_no_infinite_epsilon_is_tried_with_its_own() -> None:
    @dataclass(frozen=True)
    class Springs(Semismooth):
        epsilon: float = 1e4

        def __post_init__(self) -> None:
            if math.isinf(self.epsilon):
                raise ValueError("it needs springs")

    ALGORITHMS["springs"] = Springs
    assert epsilon_of("springs") == 1e4


@pytest.mark.parametrize("error", [KeyError("lost"), SystemExit(0), MemoryError("a dense matrix")])
def test_an_exception_and_a_loop_without_end_are_ends(error: BaseException) -> None:
    case = next(iter(problems.made(math.inf)))

    class Raising(Semismooth):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            raise error

    class Endless(Semismooth):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            while True:
                try:
                    np.ones(3).sum()
                except Exception:
                    continue

    ALGORITHMS["raising"], ALGORITHMS["endless"] = Raising, Endless
    assert alone("raising", case, 5.0).ended == RAISED
    assert alone("endless", case, 0.2).ended == LATE


def test_a_false_claim_is_told_with_the_bound_that_it_breaks() -> None:
    class Off(Semismooth):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            solution = super().solve(problem, start)
            return replace(solution, u=solution.u * (1 + 1e-6))

    ALGORITHMS["off"] = Off
    bounded = r"equilibrium \d\S* above 1e-08\b"
    for result in (
        alone("off", next(iter(problems.made(math.inf))), 5.0),
        asked(problems.Asked("scene", "heavy-strip", "4x1"), 5.0, contact="off"),
    ):
        assert result.ended == FALSE
        assert re.search(bounded, result.reason), result.reason


def test_the_clock_is_put_back_and_no_except_keeps_it() -> None:
    assert not issubclass(Overtime, Exception)
    with pytest.raises(Overtime), within(0.01):
        time.sleep(5)
    with within(60.0):
        pass
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0


def busy(seconds: float) -> Iterator[float]:
    """What the clock of the processor says, again and again."""
    until = time.process_time() + seconds
    while (now := time.process_time()) < until:
        yield now


def test_a_limit_inside_another_leaves_that_in_force() -> None:
    """As the epsilon of an algorithm is asked for within a law of it."""

    def both() -> None:
        with within(0.3):
            with within(60.0):
                pass
            assert list(busy(5.0))

    with pytest.raises(Overtime):
        both()


def test_the_clock_of_a_trial_does_not_tick_slower_under_its_limit() -> None:
    """A timer of processor time has it tick in 4 ms, which is as long as a quick trial takes."""
    with within(60.0):
        assert len(set(busy(0.1))) > 1000


@pytest.mark.slow
def test_the_sample_is_small_varied_and_certified() -> None:
    taken = sample()
    assert 18 <= len(taken) <= 30
    assert len({each.candidate.name for each in taken}) == len(taken)
    assert {each.traits.kind for each in taken} == {"definite", "indefinite", "not symmetric"}
    assert {each.traits.coupling for each in taken} == {"lumped", "consistent"}
    assert all(each.answer.confirmed_by for each in taken)


# --- who it is of -----------------------------------------------------------------------------------------------------


def test_what_a_file_adds_is_found_and_a_name_is_a_part_of_ours() -> None:
    kinds = {"hasty": ALGORITHM, "slanted": MEASURE, "boastful": SOLVER, "halfway": ELEMENT}
    for name, kind in kinds.items():
        subject = part(name)
        assert (subject.kind, subject.name) == (kind, name)
        assert name not in subject.ours
    ours = {"semismooth": ALGORITHM, "exact": MEASURE, "OSQP, scaled": SOLVER, "nodal": ELEMENT}
    assert {name: [each.kind for each in subjects(name)] for name in ours} == {k: [kind] for k, kind in ours.items()}


CATALOGUE = "from studies.arena.solvers.catalogue import SOLVERS\n"
WRONG = {
    "1/0": "ZeroDivisionError",
    "x = 1": "it adds nothing to any catalogue",
    "from contact.catalogue import ALGORITHMS\nALGORITHMS['half'] = object": "the part has no parameters",
    "from contact.catalogue import ALGORITHMS\nALGORITHMS['lcp'] = ALGORITHMS['qp']": (
        "'lcp' of footprint.contact: the name is taken by another part; choose another one"
    ),
    CATALOGUE + "SOLVERS['new'] = 3": "must be a studies.arena.solvers",
    CATALOGUE + "from studies.arena.solvers.outside import Outside\n"
    "SOLVERS['new'] = Outside('new', call=lambda programme, eps: None)": (
        "'new' cannot be sent to the process that solves"
    ),
    "from formulations.element.mixed import THICKNESS_STRAINS\nTHICKNESS_STRAINS['new'] = 3": "in [0, 1]",
}


@pytest.mark.parametrize(("source", "says"), WRONG.items(), ids=range(len(WRONG)))
def test_a_wrong_file_is_one_line(source: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "nothing.py"
    file.write_text(source, encoding="utf-8")
    assert main(["card", str(file), "--out", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert says in message
    assert list(tmp_path.glob("card-*")) == []


def test_wrong_use_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("kept", encoding="utf-8")
    for arguments, says in (
        ([], "card takes one of FILE.py, NAME and --template DIR"),
        (["nobody"], "'nobody' must be a file that ends in .py, or one of trial-and-error"),
        ([str(tmp_path / "nothing.py")], "no such file"),
        (["--template", str(tmp_path)], "must be an empty directory"),
    ):
        assert main(["card", *arguments]) == 2
        message = capsys.readouterr().err
        assert message.count("\n") == 1
        assert says in message
    assert {path.name for path in tmp_path.iterdir()} == {"mine.txt"}


# --- the command ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_check_is_the_exit_code_and_one_page_with_its_picture_is_written(
    few: None, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    assert main(["card", str(PARTS / "hasty.py"), "--check", "--out", str(tmp_path)]) == 1
    assert capsys.readouterr().out.startswith("`hasty` FAILS")
    assert {path.name for path in tmp_path.iterdir()} == {"card-hasty.md", "card-hasty.svg"}
    assert main(["card", str(PARTS / "twice.py"), "--check", "--out", str(tmp_path / "sub" / "mine.md")]) == 0
    assert {path.name for path in (tmp_path / "sub").iterdir()} == {"mine.md", "mine.svg"}
    text = (tmp_path / "sub" / "mine.md").read_text(encoding="utf-8")
    assert re.search(r"\*\*`twice` passes: it solves \d+ of \d+ problems, no claim is false", text)


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_the_entries_of_the_arena_have_cards(name: str, few: None) -> None:
    (subject,) = subjects(str(FILES[name]))
    card = card_of(beside(subject, "semismooth"))
    assert card.passes, card.verdict


def test_the_algorithm_of_the_manual_keeps_every_law(tmp_path: Path) -> None:
    file = tmp_path / "saddle.py"
    file.write_text(file_of("algorithm", file.name), encoding="utf-8")
    (subject,) = subjects(str(file))
    assert [law for law in laws_of(subject.name) if not law.passed] == []


@pytest.mark.slow
def test_the_layout_of_a_submission_has_an_algorithm_that_passes(few: None, tmp_path: Path) -> None:
    place = tmp_path / "new"
    assert main(["card", "--template", str(place)]) == 0
    names = {path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file()}
    assert names == {*("README.md", "my_algorithm.py", ".github/workflows/card.yml")}
    assert "footprint card my_algorithm.py --check" in (place / ".github/workflows/card.yml").read_text("utf-8")
    (subject,) = subjects(str(place / "my_algorithm.py"))
    card = card_of(beside(subject, "semismooth"))
    assert card.passes, card.verdict
