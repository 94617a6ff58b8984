"""The arena in public: the data set, results of others, the ranking, and problems that nobody sees."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.interchange.linearised_step import FrozenStep
from studies.arena import held_out, results
from studies.arena.collected import dataset
from studies.arena.collected.certified import confirm, find
from studies.arena.collected.collection import KEPT, TEST, TUNE, kept_names, split_of, sums
from studies.arena.collected.frictional import FRICTIONAL
from studies.arena.collected.rule import STEPS
from studies.arena.ranking import board, read_all, read_result
from studies.arena.results import Asked, Counted, Result, Solved, harness, here, results_of
from studies.ask.request import UsageError
from studies.cli import main

KEY = b"a secret of the tests"
TESTED = tuple(name for name in STEPS.manifest()["name"] if split_of(name) == TEST)[:4]
TUNED = next(name for name in STEPS.manifest()["name"] if split_of(name) == TUNE)
HEADS = ("solver", "problem", "tolerance", "asked", "claimed", "false", "seconds", "factorisation_s", "reason")


def result(entry: str, solved: int, *, cost: float = 2.0, false: int = 0, kernels: str = "own", by: str = "") -> Result:
    """One that solves so many of four problems at a cost, claims some more falsely, and fails at the rest."""
    statuses = ["ok"] * solved + ["anomalous"] * false + ["failed"] * (4 - solved - false)
    public = [
        Solved(name, word, cost if word == "ok" else math.nan) for name, word in zip(TESTED, statuses, strict=True)
    ]
    counts = Counted({"ok": solved, "anomalous": false, "failed": 4, "missing": 0, "excluded": 0}, cost, "0" * 16)
    asked = Asked(1e-6, (*public, Solved(TUNED, "ok", 1e-3)), counts)
    return Result(entry, {**here(), "kernels": kernels}, by or harness(), dataset.identity(), 20.0, (asked,))


# --- the data set -----------------------------------------------------------------------------------------------------


def test_what_is_of_one_scene_is_in_one_split() -> None:
    """Meshes, loads, iterates and forms; and each kind of matrix is in both."""
    names = ["panel-6x6-delta_mm=10-s1i12", "panel-14x14-delta_mm=10-s2i3", "panel-2x2-delta_mm=10-s1i0-condensed"]
    assert len({split_of(name) for name in [*names, "panel-6x6-delta_mm=10-s1i12-touching"]}) == 1
    assert split_of("OBSTCLAL-5") == split_of("OBSTCLAL-46-touching")
    assert len({split_of(f"panel-6x6-delta_mm={each}-s1i0") for each in range(40)}) == 2
    kept = STEPS.manifest()
    shares = (kept["split"] == TUNE).groupby(kept["kind"]).mean()
    assert shares.between(0.1, 0.4).all()


def test_the_card_counts_what_the_manifests_have() -> None:
    card = dataset.card()
    kept = STEPS.manifest()
    assert f"{len(kept)} problems without friction" in card
    assert dataset.identity() in card
    assert "$" not in card
    tuned = int((kept["split"] == TUNE).sum() + (FRICTIONAL.manifest()["split"] == TUNE).sum())
    assert f"`tune` ({tuned} problems)" in card


def test_a_file_that_is_not_as_shipped_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in "abc":
        (tmp_path / f"{name}.npz").write_bytes(name.encode())
    monkeypatch.setattr(dataset, "_names", lambda: list("abc"))
    dataset.write_card(tmp_path)
    assert list(dataset.altered(tmp_path)) == []
    (tmp_path / "a.npz").write_bytes(b"A")
    (tmp_path / "b.npz").unlink()
    with (tmp_path / "SHA256SUMS").open("a") as file:
        file.write(f"{'0' * 64}  ../passwd.npz\n")
    lines = list(dataset.altered(tmp_path))
    assert [line.partition(":")[0] for line in lines] == ["a", "b", "SHA256SUMS"]


# --- results ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_each_way_to_end_has_its_status(tmp_path: Path) -> None:
    rows = [
        ("one", TESTED[0], 1e-6, True, True, False, 3.0, 1.5, "solved"),
        ("one", TESTED[1], 1e-6, True, True, True, 3.0, 1.5, "solved"),
        ("one", TESTED[2], 1e-6, True, False, False, np.nan, 1.5, "killed after 20 s"),
        ("one", TESTED[3], 1e-6, False, False, False, np.nan, np.nan, "K is not symmetric"),
        ("two", TESTED[0], 1e-6, False, False, False, np.nan, np.nan, "not installed: pip install two"),
    ]
    table = pd.DataFrame(rows, columns=list(HEADS))
    one, two = results_of({"public": table, "held_out": table.iloc[:3]}, 20.0, [*TESTED, TUNED], "1" * 16)
    ends = {each.problem: each.status for each in one.tolerances[0].public}
    assert ends == dict(zip([*TESTED, TUNED], ("ok", "anomalous", "failed", "excluded", "missing"), strict=True))
    assert one.tolerances[0].public[0].cost == 2.0
    assert {each.status for each in two.tolerances[0].public} == {"missing"}
    counts = one.tolerances[0].held_out
    assert counts is not None
    assert (counts.statuses["ok"], counts.statuses["anomalous"], counts.statuses["failed"]) == (1, 1, 1)
    assert two.tolerances[0].held_out is None
    again = read_result(one.write(tmp_path))
    assert str(again) == str(one)  # NaN is not itself
    assert not again.stale


def damaged(**changes: object) -> str:
    known = asdict(result("mine", 2, by="0" * 16))
    record = {"format": results.FORMAT, "format_version": results.VERSION, **known, **changes}
    return json.dumps(json.loads(json.dumps(record).replace("NaN", "null")))


def with_problem(**changes: object) -> str:
    given = {"problem": TESTED[0], "status": "ok", "cost": 1.0, **changes}
    return damaged(tolerances=[{"tolerance": 1e-6, "public": [given], "held_out": None}])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "Expecting"),
        ("[]", "it = [] must be a JSON object"),
        ("[" * 10_000, "nests deeper"),
        (damaged(format="other"), "not of the format"),
        (damaged(entry=3), "entry = 3 must be 1 to 80 printable characters"),
        (damaged(entry="x" * 81), "must be 1 to 80 printable characters"),
        (damaged(entry="a\x1b[2J\nb"), "must be 1 to 80 printable characters"),
        (damaged(entry="‮evil"), "must be 1 to 80 printable characters"),
        (damaged(machine=[]), "machine = [] must be a JSON object"),
        (damaged(harness="../x"), "16 hexadecimal digits"),
        (damaged(limit_s=True), "limit_s = True must be a number"),
        (damaged(limit_s=20).replace("20", "1e999"), "not a finite number"),
        (damaged(limit_s=20).replace("20", "NaN"), "not a finite number"),
        (damaged(limit_s=20).replace("20", "9" * 5000), "too large a whole number"),
        (damaged(limit_s=1e300), "must be a number in [0.001, 1e+06]"),
        (damaged(tolerances=[]), "must be a list of 1 to 10"),
        (damaged(tolerances=[{"tolerance": 2.0}]), "tolerance = 2.0 must be a number"),
        (with_problem(problem="../../etc/passwd"), "must be the name of one"),
        (with_problem(status="best"), "must be one of ok, anomalous"),
        (with_problem(cost="1"), "cost = '1' must be a number"),
        (with_problem(cost=-1), "must be a number in [0, 1e+12]"),
    ],
)
def test_what_is_no_result_is_one_line(
    text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "x.json").write_text(text, encoding="utf-8")
    assert main(["leaderboard", str(tmp_path / "results"), "--out", str(tmp_path / "board")]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert says in message
    assert len(message) < 400
    assert not (tmp_path / "board").exists()


def test_two_results_of_one_entry_and_machine_are_refused(tmp_path: Path) -> None:
    path = result("mine", 2).write(tmp_path)
    path.with_name("copy.json").write_bytes(path.read_bytes())
    with pytest.raises(UsageError, match="two results on the machine"):
        read_all(tmp_path)


# --- the ranking ------------------------------------------------------------------------------------------------------


def test_who_solves_more_is_first_then_who_claims_less_falsely_then_the_cheaper() -> None:
    """The split for tuning counts for nothing; equal entries share a rank; the worst machine counts."""
    ranking = board(
        [
            result("dear", 3, cost=9.0),
            result("cheap", 3, cost=2.0),
            result("as cheap", 3, cost=2.0),
            result("boastful", 3, cost=1.0, false=1),
            result("fickle", 4),
            result("fickle", 1, kernels="Nehalem"),
        ]
    )
    order = [(row["rank"], row["entry"]) for row in ranking.ranked]
    assert order == [(1, "as cheap"), (1, "cheap"), (3, "dear"), (4, "boastful"), (5, "fickle")]
    assert ranking.ranked[0]["cost"] == pytest.approx(2.0)
    assert (ranking.ranked[-1]["ok"], ranking.ranked[-1]["machines"], ranking.ranked[-1]["asked"]) == (1, 2, 4)


def test_a_changed_harness_makes_older_results_stale(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    results_in = tmp_path / "results"
    result("old", 4).write(results_in)
    assert [each.stale for each in read_all(results_in)] == [False]
    monkeypatch.setattr(results, "harness", lambda: "f" * 16)
    replace(result("new", 1), harness="f" * 16).write(results_in)
    assert main(["leaderboard", str(results_in), "--out", str(tmp_path / "board")]) == 0
    assert "1 entries, 2 results, 1 stale" in capsys.readouterr().out
    text = (tmp_path / "board" / "leaderboard.md").read_text(encoding="utf-8")
    assert "| 1 | new |" in text
    assert "| old |" in text
    assert "| stale |" in text
    assert "1 of 2 results are stale" in text


def test_the_checksum_is_of_who_judges_and_not_of_who_is_judged() -> None:
    from studies.run.source_hash import closure

    modules = closure(results.HARNESS, without=results.NOT_HARNESS)
    assert {"studies.arena.answers", "studies.arena.solvers.process"} <= modules
    assert "studies.arena.solvers.outside" not in modules


class Tags(HTMLParser):
    """The tags of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found += [(tag, str(value)) for _, value in attrs] or [(tag, "")]


def test_six_entries_on_two_machines_make_a_page_and_names_stay_text(tmp_path: Path) -> None:
    names = ["<img src=x onerror=alert(1)>", "[a](javascript:alert(1))", "a|b", "`c`", "**d**", "e"]
    for at, name in enumerate(names):
        for kernels in ("own", "<script>alert(1)</script>"):
            result(name, at % 4, kernels=kernels).write(tmp_path / "results")
    assert main(["leaderboard", str(tmp_path / "results"), "--out", str(tmp_path / "board")]) == 0
    files = {path.name: path.read_text(encoding="utf-8") for path in (tmp_path / "board").iterdir()}
    assert set(files) == {"leaderboard.md", "leaderboard.html"}
    ranking = files["leaderboard.md"].partition("**Ranking**")[2].partition("## By machine")[0]
    assert len([line for line in ranking.splitlines() if line.startswith("| ")]) == 2 + len(names)
    html = files["leaderboard.html"]
    assert html.index("Ranking") < html.index("By machine")
    assert "&lt;img src=x" in html
    body = html.partition("<main")[2].partition("</main>")[0]
    assert not [each for each in Tags(body).found if each[0] in ("img", "script") or "javascript" in each[1]]


# --- what nobody sees -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "families", [("relief",), pytest.param(tuple(held_out.FAMILIES), marks=pytest.mark.slow)], ids=len
)
def test_a_secret_draws_its_problems_again_and_another_one_others(
    families: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(held_out, "FAMILIES", {name: held_out.FAMILIES[name] for name in families})
    one, again, other = (held_out.problems(key, each=1) for key in (KEY, KEY, KEY + b"!"))
    assert set(one) == {f"{name}-1" for name in families}
    for name, step in one.items():
        assert sums(step) == sums(again[name])
        assert sums(step) != sums(other[name])  # from rest there is no residual to differ in
        assert confirm(step, find(step)).confirmed_by
    assert held_out.digest(KEY) != held_out.digest(KEY + b"!")


def test_a_secret_is_asked_for_and_is_long(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(held_out.SECRET, raising=False)
    with pytest.raises(UsageError, match="needs a secret"):
        held_out.secret()
    monkeypatch.setenv(held_out.SECRET, "short")
    with pytest.raises(UsageError, match="a secret of 5 bytes must have 16 to 1024"):
        held_out.secret()
    (tmp_path / "key").write_bytes(KEY + b"\n")
    assert held_out.secret(tmp_path / "key") == KEY
    (tmp_path / "long").write_bytes(bytes(5000))
    with pytest.raises(UsageError, match="is not a secret"):
        held_out.secret(tmp_path / "long")


@pytest.mark.slow
def test_a_run_hands_in_both_tiers_and_writes_no_problem_that_is_held_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(held_out.SECRET, KEY.decode())
    monkeypatch.setattr(held_out, "FAMILIES", {"relief": held_out.FAMILIES["relief"]})
    name = min(kept_names(), key=len)
    problems = tmp_path / "problems"
    problems.mkdir()
    (problems / f"{name}.npz").write_bytes(KEPT.joinpath(f"{name}.npz").read_bytes())
    folders = ["--out", str(tmp_path / "run"), "--results", str(tmp_path / "results"), "--problems", str(problems)]
    command = ["bench", "solvers", "--rounds", "1", "--only", "semismooth", *folders]
    assert main([*command, "--held-out"]) == 0
    (handed_in,) = read_all(tmp_path / "results")
    at = handed_in.tolerances[-1]
    assert [each.problem for each in at.public if each.status == "ok"] == [name]
    assert at.held_out is not None
    assert (at.held_out.statuses["ok"], at.held_out.secret) == (held_out.EACH, held_out.digest(KEY))
    assert [path.name for path in tmp_path.rglob("*.npz")] == [f"{name}.npz"]
    text = "".join(path.read_text(encoding="utf-8") for path in (tmp_path / "results").iterdir())
    assert "relief" not in text
    assert KEY.decode() not in text
    step = FrozenStep.read(problems / f"{name}.npz")
    replace(step, r=2 * step.r).write(problems / f"{name}.npz")
    capsys.readouterr()
    assert main(command) == 2
    assert f"--results is of the collection: {name}: sum_r is" in capsys.readouterr().err
    assert main(["bench", "solvers", "--results", str(tmp_path)]) == 2
    assert "--results needs --problems DIR, --held-out, or both" in capsys.readouterr().err
