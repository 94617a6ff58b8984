"""Campaigns that meet whatever may happen: cells that hang, eat memory or die, kills, damage, full disks."""

from __future__ import annotations

import gc
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from studies.ask.scene import UsageError
from studies.cli import main
from studies.run.archive import Archive
from studies.run.campaign import find
from studies.run.collect import collect
from studies.run.running import run
from studies.run.task import Limits
from support.stores.campaigns import SMALL, again, content, small

PLANTED = '''
import os, signal, time
from dataclasses import dataclass

import numpy as np

from studies.ask.scene import Setting
from studies.scenes import SCENES
from studies.scenes.benchmarks.cantilever import Cantilever

WAYS = ("fine", "hangs", "sleeps", "eats", "dies", "raises")


@dataclass(frozen=True)
class Planted(Cantilever):
    """A cantilever that, asked so, does not come back."""

    name: str = "planted"
    settings: tuple = (*Cantilever().settings, Setting("way", "fine", "what it does", "choice", choices=WAYS))

    def build(self, request):
        way = request.settings["way"]
        if way == "hangs":
            while True:
                pass
        if way == "sleeps":
            time.sleep(600)
        if way == "eats":
            kept = [np.ones(10_000_000) for _ in range(100)]  # 8 GB
        if way == "dies":
            os.kill(os.getpid(), signal.SIGSEGV)
        if way == "raises":
            raise RuntimeError("planted")
        return super().build(request)


SCENES["planted"] = Planted()
'''
# --- outcomes -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_cells_that_do_not_come_back_are_classified_and_the_campaign_goes_on(tmp_path: Path) -> None:
    """The planted cells stand between sound ones, which must not notice; the hung ones are really gone."""
    ways = ["fine", "sleeps", "eats", "dies", "raises", "hangs"]
    (tmp_path / "planted_cells.py").write_text(PLANTED)
    text = f'modules = ["planted_cells"]\n[[cross]]\n[cross.scenes.planted]\nmeshes = ["2x1"]\nvary.way = {ways}\n'
    (tmp_path / "odd.toml").write_text(text + '[cross.scenes.cantilever]\nmeshes = ["2x1"]\n')
    store, limits = tmp_path / "store", Limits(8.0, 400.0)
    began = time.monotonic()
    summary = run(find(str(tmp_path / "odd.toml"), trust=True), store, "local:2", limits)
    assert time.monotonic() - began < 90
    table = collect(store, "odd").set_index("label")
    ended = {way: table.loc[f"cross planted 2x1 way={way}"] for way in ways}
    assert {way: row["outcome"] for way, row in ended.items()} == {
        **{"fine": "converged", "sleeps": "time", "eats": "memory", "dies": "crash"},
        **{"raises": "crash", "hangs": "time"},
    }
    assert ended["sleeps"]["reason"] == "killed after 8 s"
    assert "more than 400 MB" in ended["eats"]["reason"]
    assert ended["dies"]["reason"] == "killed by SIGSEGV"
    assert ended["raises"]["reason"].startswith("scene 'planted': planted_cells.py:")
    assert table.loc["cross cantilever 2x1", "outcome"] == "converged"
    assert summary.classes == {"converged": 2, "time": 2, "memory": 1, "crash": 2}
    # no failure is taken for a result: all are tried again, and only they
    assert len(list((store / "cells").glob("*.json"))) == 2
    soon = Limits(0.5, 400.0)  # however they end
    assert run(find(str(tmp_path / "odd.toml"), trust=True), store, "local:2", soon).solved == 5


def test_a_failure_that_is_none_any_more_is_forgotten(own: Path, tmp_path: Path) -> None:
    path = next((own / "cells").glob("*.json"))
    path.unlink()
    Archive(own).note_failure(path.stem, {"class": "time", "reason": "killed after 1 s"})
    assert collect(own, "small")["outcome"].value_counts()["time"] == 1
    assert again(tmp_path, own).solved == 1
    assert list((own / "failures").glob("*")) == []


@pytest.mark.slow
def test_combinations_that_make_no_sense_are_rows_with_their_reason(tmp_path: Path) -> None:
    path = tmp_path / "odd.toml"
    path.write_text(
        'cross = [{ contacts = "all", epsilons = ["inf"], scenes = { ring = { meshes = ["1x8"] }}},\n'
        '{ contacts = ["semismooth", "lcp"], scenes = { hemisphere = { meshes = ["4x4"] }}},\n'
        '{ models = ["half"], scenes = { hemisphere = { meshes = ["4x4"] }}},\n'
        '{ scenes = { tyre = { meshes = ["7x7"], set = { delta_mm = "2" } }}}]\n'
    )
    run(find(str(path)), tmp_path / "store")
    table = collect(tmp_path / "store", "odd").set_index("label")
    refused = table[table["outcome"] == "unsupported"]["reason"]
    assert set(refused.index) == {
        "cross ring regularised 1x8 epsilon=inf",
        "cross hemisphere half 4x4",
        "cross tyre 7x7",
    }
    assert "needs a finite epsilon" in refused["cross ring regularised 1x8 epsilon=inf"]
    assert table.loc["cross hemisphere semismooth 4x4", "outcome"] == "converged"  # without contact: for all of them
    assert "cross hemisphere lcp 4x4" not in table.index
    assert refused["cross hemisphere half 4x4"].startswith("model 'half' must be one of")
    assert "even" in refused["cross tyre 7x7"]
    assert run(find(str(path)), tmp_path / "store").solved == 0  # a refusal is a result


# --- kills and damage ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "damage", ["half", *(pytest.param(text, marks=pytest.mark.slow) for text in ("other", "", '{"schema": 1}', "[]"))]
)
def test_a_damaged_record_is_set_aside_with_a_line_and_solved_again(
    damage: str, own: Path, solved: Path, tmp_path: Path
) -> None:
    path, other = sorted((own / "cells").glob("*.json"))[:2]
    text = path.read_text()
    path.write_text({"half": text[: len(text) // 2], "other": other.read_text()}.get(damage, damage))
    damaged, said = path.read_text(), []
    with pytest.raises(UsageError, match="footprint run sets it aside"):
        collect(own, "small")
    assert again(tmp_path, own, say=said.append).solved == 1
    assert len(said) == 1
    assert f"set aside as {own / 'aside' / path.name}, solved again" in said[0]
    assert "\n" not in said[0]
    assert (own / "aside" / path.name).read_text() == damaged  # nothing is lost
    shutil.rmtree(own / "aside")
    assert content(own) == content(solved)


@pytest.mark.parametrize("place", ["old", "index"])
def test_a_store_of_another_schema_is_refused_and_not_touched(
    place: str, own: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (own / ("campaign.json" if place == "old" else "campaigns/other.json")).write_text('{"schema": 1}')
    before = content(own)
    assert main(["run", str(small(tmp_path)), "--store", str(own)]) == 2
    assert capsys.readouterr().err == (
        f"footprint: {own} has schema 1, this program writes 2: choose another --store\n"
    )
    assert content(own) == before


@pytest.mark.slow
def test_two_runs_of_one_store_are_one_and_a_refusal(
    solved: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The lock goes with its process, so that none is ever stale."""
    store = tmp_path / "store"
    with Archive(store).claimed():
        assert main(["run", str(small(tmp_path)), "--store", str(store)]) == 2
        said = capsys.readouterr().err
        assert said == f"footprint: {store} is in use by another run; wait for it or choose another --store\n"
    code = "from pathlib import Path; from studies.run.archive import Archive; import time\n"
    code += f"with Archive(Path({str(store)!r})).claimed(): print('held', flush=True); time.sleep(60)"
    holder = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert holder.stdout is not None
    assert holder.stdout.readline() == b"held\n"
    with pytest.raises(UsageError, match="in use"):
        again(tmp_path, store)
    holder.kill()
    holder.wait()
    holder.stdout.close()
    again(tmp_path, store)
    assert content(store) == content(solved)


def test_campaigns_share_a_store_and_its_cells(own: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.toml"
    other.write_text(SMALL.replace('name = "small"', 'name = "another"'))
    assert run(find(str(other)), own).solved == 0
    assert Archive(own).campaigns() == ["other", "small"]


def test_resume_only_goes_on(own: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="has no campaign 'small' yet"):
        again(tmp_path, tmp_path / "mistyped", resume=True)
    assert not (tmp_path / "mistyped").exists()
    assert again(tmp_path, own, resume=True).solved == 0


# --- engines ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_side_by_side_it_is_the_same_store(solved: Path, tmp_path: Path) -> None:
    again(tmp_path, tmp_path / "store", engine="local:2")
    assert content(tmp_path / "store") == content(solved)


@pytest.mark.slow
def test_a_cluster_of_dask_makes_the_same_store(solved: Path, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="needs the extra dask")
    with distributed.LocalCluster(
        processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None
    ) as cluster:
        again(tmp_path, tmp_path / "store", engine=f"dask:{cluster.scheduler_address}")
    gc.collect()  # the worker, and its processes with it
    assert content(tmp_path / "store") == content(solved)


def test_an_engine_that_is_none_is_one_line(tmp_path: Path) -> None:
    for name in ("local", "local:0", "local:65", "local:x", "dask:", "ray"):
        with pytest.raises(UsageError, match="must be serial, local:N"):
            again(tmp_path, tmp_path / "store", engine=name)
    assert not (tmp_path / "store").exists()


MANY = f"[[cross]]\nvary = {{ {', '.join(f'k{i} = [1, 2, 3, 4]' for i in range(9))} }}\n[cross.scenes.tyre]"
TWICE = "".join(f"[[cross]]\nsteps = {n}\nmeshes = ['4x1']\n[cross.scenes.cantilever]\n" for n in (1, 2))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("crosses = []", "key 'crosses' must be one of title"),
        ("[[cross]]\nmeshs = []", "key 'meshs' must be one of"),
        ("[[cross]]\nname = 'x'", "needs its scenes"),
        ("[[cross]]\n[cross.scenes.tire]", "'tire' in scenes must be one of tyre"),
        ("[[cross]]\nmeasures = ['exat']\n[cross.scenes.tyre]", "'exat' in measures must be one of"),
        ("lists = ['all']", "'all' in lists must be one of"),
        (TWICE, "two cells have the label"),
        ("modules = ['own']", "runs own.py beside it: allow this by footprint run --trust"),
        ("modules = ['../own']", "'../own', which must be the name of a module beside it"),
        ("modules = [1]", "modules[0] = 1 must be a text"),
        ("cross = 1", "cross = 1 must be a list"),
        ("cross = [1]", "cross[0] = 1 must be a set of values by name"),
        ("cross = [{scenes = {panel = 1}}]", "scenes.panel = 1 must be a set"),
        ("lists = [[]]", "lists = [1 values] must be a list of numbers or words"),
        (f"title = '{chr(0x202E)}'", "title = '\\u202e' must be a text that is printed on one line"),
        (MANY, "exceeds a limit: 100000 cells"),
        ("title = ", "campaign"),
    ],
)
def test_a_campaign_file_that_is_wrong_is_one_line(
    text: str, says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "c.toml").write_text(text)
    assert main(["run", str(tmp_path / "c.toml"), "--store", str(tmp_path / "store")]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
