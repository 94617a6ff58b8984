"""What strangers send does no harm: one line, exit 1 or 2, within a GiB and five seconds, and nothing left behind.

Each case runs a whole command in this process, under a limit of its memory.
"""

from __future__ import annotations

import json
import re
import resource
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact.problem import ContactSolution
from studies.cli import main
from studies.gate.foreign import ClaimError
from studies.gate.recompute import arrays_of, as_written, state_of
from studies.output.atomic import PART
from studies.output.vtu import packed_arrays, write_vtu
from studies.run.archive import Archive
from studies.run.plan import planned
from studies.scenes.complete import Cell, complete
from support.stores.elsewhere import Elsewhere, solved
from support.stores.hostile import (
    ANSWERS,
    ARRAYS,
    CAMPAIGNS,
    ESCAPE,
    LCPS,
    ODD,
    PLANS,
    PROBLEMS,
    RECORDS,
    RESULTS,
    STEP,
    changed,
    npz,
    step_with,
)

GIB, SECONDS = 2**30, 5.0  # of processor time
TINY = """
[[cross]]
name = "a"
measures = ["exact", "linear"]
[cross.scenes.cantilever]
meshes = ["2x1"]
"""
CELL = "a cantilever exact 2x1"
CONTROL = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u202a-\u202e]")


@contextmanager
def bounded() -> Iterator[None]:
    """A GiB more than there is, and five seconds."""
    if sys.platform == "linux":
        used = int(Path("/proc/self/status").read_text().partition("VmData:")[2].split()[0]) * 1024
        soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (used + GIB, hard))
    began = time.process_time()
    try:
        yield
    finally:
        if sys.platform == "linux":
            resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
    assert time.process_time() - began < SECONDS


def said(words: list[str], capsys: pytest.CaptureFixture[str], code: int = 2) -> str:
    """What a command says that ends with this code: on stderr one line, free of control characters."""
    capsys.readouterr()
    with bounded():
        assert main(words) == code
    printed = capsys.readouterr()
    assert not CONTROL.search((printed.out + printed.err).replace("\n", ""))
    assert printed.err.count("\n") == 1, printed.err
    assert len(printed.err) < 2000
    return printed.err


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two cells."""
    return solved(tmp_path_factory.mktemp("tiny"), "tiny", TINY)


@pytest.fixture
def there(tiny: Path, tmp_path: Path) -> Elsewhere:
    """A copy of them."""
    return Elsewhere(Path(shutil.copytree(tiny, tmp_path / "there")))


# --- files --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ANSWERS)
def test_answers(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    suffix, write, says = ANSWERS[name]
    STEP.write(tmp_path / "problem.npz")
    write(tmp_path / f"answer{suffix}")
    words = ["problems", "judge", str(tmp_path / "problem.npz"), str(tmp_path / f"answer{suffix}")]
    assert re.search(says, said(words, capsys))


@pytest.mark.parametrize("name", PROBLEMS)
def test_problems(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write, says = PROBLEMS[name]
    write(tmp_path / "problem.npz")
    (tmp_path / "answer.json").write_text("{}")
    out = tmp_path / "out.mat"
    judge = ["judge", str(tmp_path / "problem.npz"), str(tmp_path / "answer.json")]
    export = ["export", str(tmp_path / "problem.npz"), "--format", "mat", "--out", str(out)]
    for words in (judge, export):
        assert re.search(says, said(["problems", *words], capsys))
    assert re.search(says, said(["resolve", str(tmp_path / "problem.npz")], capsys))
    assert not out.exists()


@pytest.mark.slow
def test_an_array_that_nobody_asked_for_is_not_unpacked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """More than fits, beside an answer that is judged all the same."""
    STEP.write(tmp_path / "problem.npz")
    npz(ARRAYS, {"more": 1100})(tmp_path / "answer.npz")
    with bounded():
        assert main(["problems", "judge", str(tmp_path / "problem.npz"), str(tmp_path / "answer.npz")]) == 0
    assert "certified" in capsys.readouterr().out


def test_escapes_in_what_a_problem_says_of_itself_are_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    meta = {"format": "footprint contact step", "format_version": 1, "scene": ESCAPE, "model": "a\nconverged"}
    step_with(meta=json.dumps(meta))(tmp_path / "problem.npz")
    assert main(["resolve", str(tmp_path / "problem.npz")]) == 0
    printed = capsys.readouterr().out
    assert r"scene \x1b]0;owned\x07\x1b[31m" in printed
    assert "of the model a converged alone" in printed
    assert not CONTROL.search(printed.replace("\n", ""))


@pytest.mark.parametrize("name", RESULTS)
def test_results_of_other_programs(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    suffix, write, says = RESULTS[name]
    write(tmp_path / f"found{suffix}")
    words = ["judge-field", "cantilever", "--mesh", "4x1", str(tmp_path / f"found{suffix}")]
    assert re.search(says, said(words, capsys))


@pytest.mark.parametrize("name", LCPS)
def test_complementarity_problems(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write, says = LCPS[name]
    write(tmp_path / "lcp.dat")
    words = ["problems", "import", str(tmp_path / "lcp.dat"), "--out", str(tmp_path / "out.npz")]
    assert re.search(says, said(words, capsys))
    assert [path.name for path in tmp_path.iterdir()] == ["lcp.dat"]


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_campaigns(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, says = CAMPAIGNS[name]
    own, ran = tmp_path / "own", tmp_path / "ran"
    own.mkdir()
    for module in (own / "beside.py", tmp_path / "beside.py"):
        module.write_text(f"import pathlib\npathlib.Path({str(ran)!r}).touch()\n")
    (own / "linked.py").symlink_to(tmp_path / "beside.py")
    (own / "c.toml").write_text(text)
    trust = [] if "nobody trusts" in name else ["--trust"]
    words = ["run", str(own / "c.toml"), "--store", str(tmp_path / "store"), *trust]
    assert re.search(says, said(words, capsys))
    assert not ran.exists()
    assert not (tmp_path / "store").exists()


# --- stores -------------------------------------------------------------------------------------------------------


def merged(there: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The one refusal of a merge that nothing of the damaged cell or plan comes out of."""
    line = said(["merge", str(there.root), "--store", str(tmp_path / "here")], capsys, code=1)
    assert line.startswith("refused: ")
    here = tmp_path / "here"
    assert not Archive(here).record_path(there.ids[CELL]).exists()
    assert not list(here.rglob(f"{PART}*"))
    return line


@pytest.mark.slow
@pytest.mark.parametrize("name", RECORDS)
def test_records_of_a_store_that_is_merged(
    name: str, there: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, says = RECORDS[name]
    changed(there.archive.record_path(there.ids[CELL]), change)
    assert re.search(says, merged(there, tmp_path, capsys))


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANS)
def test_plans_of_a_store_that_is_merged(
    name: str, there: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    change, says = PLANS[name]
    changed(there.archive.index_path("tiny"), change)
    assert re.search(says, merged(there, tmp_path, capsys))


@pytest.mark.slow
def test_a_mesh_beyond_use_is_refused_before_it_is_built(
    there: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """500 x 500 elements, under the identity that they have here."""
    large = planned(Cell("", "cantilever", {"measure": "exact", "mesh": "500x500"}, {})).id

    def asks(plan: dict) -> None:
        plan["cells"][0]["options"]["mesh"], plan["cells"][0]["id"] = "500x500", large

    there.falsify(CELL, lambda record: record.update(id=large, mesh="500x500"))
    there.archive.record_path(there.ids[CELL]).rename(there.archive.record_path(large))
    changed(there.archive.index_path("tiny"), asks)
    assert "500x500 has 250000 elements, more than the 20000" in merged(there, tmp_path, capsys)


READERS = (["table", "tiny"], ["analyse", "tiny"], ["report"], ["compare", "{}", "--campaign", "tiny"])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "name"), [*(("record", each) for each in RECORDS), *(("plan", each) for each in PLANS)]
)
def test_a_store_that_is_read(
    what: str, name: str, there: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By every command that reads one."""
    archive = there.archive
    path = archive.record_path(there.ids[CELL]) if what == "record" else archive.index_path("tiny")
    change, says = (RECORDS if what == "record" else PLANS)[name]
    changed(path, change)
    for words in READERS:
        assert re.search(says, said(_words(words, there, tmp_path), capsys)), words
        assert not (tmp_path / "pages").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", ODD)
def test_odd_records_of_a_store_end_in_a_line_or_are_shown(
    name: str, there: Elsewhere, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changed(there.archive.record_path(there.ids[CELL]), ODD[name])
    for words in READERS:
        code = main(_words(words, there, tmp_path))
        printed = capsys.readouterr()
        assert code == 0 or (code in (1, 2) and printed.err.count("\n") == 1), (words, printed.err)


def _words(command: list[str], there: Elsewhere, tmp_path: Path) -> list[str]:
    words = [word.format(there.root) for word in command]
    words += [str(there.root)] if command[0] == "compare" else ["--store", str(there.root)]
    return words + (["--out", str(tmp_path / "pages")] if command[0] == "report" else [])


@pytest.mark.slow
def test_damaged_records_are_set_aside_and_solved_again(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By one run, whatever is wrong with them; nothing else is solved."""
    text = f'[[cross]]\nname = "a"\nvary.load_fraction = {[round(0.01 * i, 2) for i in range(1, len(RECORDS) + 2)]}\n'
    (tmp_path / "many.toml").write_text(text + '[cross.scenes.cantilever]\nmeshes = ["2x1"]\n')
    words = ["run", str(tmp_path / "many.toml"), "--store", str(tmp_path / "store")]
    assert main(words) == 0
    archive = Archive(tmp_path / "store")
    ids = [row["id"] for row in archive.index("many")["cells"]]
    kept = archive.record_path(ids[-1]).read_bytes()
    for cell_id, (change, _) in zip(ids, RECORDS.values(), strict=False):
        changed(archive.record_path(cell_id), change)
    capsys.readouterr()
    assert main(words) == 0
    printed = capsys.readouterr()
    assert f"{len(ids)} converged; {len(RECORDS)} solved now" in printed.out
    lines = printed.err.splitlines()
    assert len(lines) == len(RECORDS)
    for line, (_, says) in zip(lines, RECORDS.values(), strict=True):
        assert re.search(says, line)
        assert "set aside as" in line
    assert len(list((archive.root / "aside").iterdir())) == len(RECORDS)
    assert archive.record_path(ids[-1]).read_bytes() == kept


def test_a_field_of_both_faces_is_no_state_of_a_wall_with_surfaces_between_them() -> None:
    scene, request = complete("wrapped-cylinder", {})
    model: Any = scene.build(request)
    written = as_written(model, ContactSolution.at_rest(model.n_unknowns, 0))[1]
    with pytest.raises(ClaimError, match="is of both faces alone"):
        state_of(model, written, 0)


@pytest.mark.parametrize(
    ("change", "said"), [(1, "has more than 32 bytes, 32 belong"), (-1, "has 24 bytes, 32 belong")]
)
def test_an_array_of_another_length_is_refused(tmp_path: Path, change: int, said: str) -> None:
    def packed(length: int) -> bytes:
        path = tmp_path / "fields.vtu"
        write_vtu(path, np.zeros((8, 3)), np.arange(8)[None], {}, {"H_11-": np.ones(length)})
        return path.read_bytes()

    wanted = {name: each.values.ravel() for name, each in packed_arrays(packed(4)).items()}
    assert arrays_of(packed(4), wanted)["H_11-"].tolist() == [1.0] * 4
    with pytest.raises(ClaimError, match=said):
        arrays_of(packed(4 + change), wanted)
