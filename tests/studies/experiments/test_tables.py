"""Tables of the whole store: made once for one state of the sources, and the ladders of the convergence study."""

import hashlib
import sys
from itertools import pairwise
from pathlib import Path
from pkgutil import resolve_name

import pandas as pd
import pytest

from studies.analysis import everything
from studies.commands import worker
from studies.commands.worker import make_table
from studies.output.atomic import write_table_once
from studies.run import source_hash
from studies.run.lists import LADDERS, LISTS, MAKERS, ladder_cells
from studies.run.plan import planned
from studies.run.source_hash import data_of, hashed
from studies.scenes import SCENES
from support.kinds import MANY_SURFACES, OF_SOLIDS, ON_QUADS


def test_a_table_with_its_identity_is_not_made_again(tmp_path: Path) -> None:
    made = []

    def make() -> pd.DataFrame:
        made.append(len(made))
        return pd.DataFrame({"x": made})

    path = tmp_path / "tables" / "t.csv"
    assert write_table_once(path, "a", make)
    assert not write_table_once(path, "a", make)
    assert path.read_text() == "x\n0\n"
    assert write_table_once(path, "b", make)  # other sources
    path.unlink()
    assert write_table_once(path, "b", make)
    assert len(made) == 3
    assert not list(tmp_path.rglob(".part-*"))


def test_a_table_stopped_between_its_two_files_is_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table of b is there and its identity is not: neither a nor b may take it for its own."""
    path = tmp_path / "t.csv"
    write_table_once(path, "a", lambda: pd.DataFrame({"x": [1]}))

    def stopped(path: Path, text: str) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("studies.output.atomic.write_text", stopped)
        with pytest.raises(KeyboardInterrupt):
            write_table_once(path, "b", lambda: pd.DataFrame({"x": [2]}))
    assert path.read_text() == "x\n2\n"
    assert write_table_once(path, "a", lambda: pd.DataFrame({"x": [1]}))
    assert path.read_text() == "x\n1\n"


def test_the_report_has_all_tables() -> None:
    assert {*LISTS["report"].tables, *LISTS["statements"].tables} == set(MAKERS)


def test_every_table_has_a_function_that_makes_it() -> None:
    made = {name: resolve_name(maker) for name, maker in MAKERS.items()}
    assert all(map(callable, made.values()))
    assert len(set(made.values())) == len(MAKERS)  # each its own
    assert all(callable(resolve_name(fit)) for _, fit in everything.DECLARED["fitted"].values())


def test_every_scene_is_on_a_ladder_of_three_meshes_or_more() -> None:
    of_the_solid = {cell.scene for cell in LISTS["solid"].cells()}
    # the panel has no reference and converges to nothing that is asked: it is there to be driven to extremes; the
    # errors of manufactured scenes are known, their orders a table of their own
    others = {"panel", "manufactured", "manufactured-contact", *(OF_SOLIDS - MANY_SURFACES)}
    of_the_experiment = {"crushed-ring", "crushed-ring-solid"}  # on four meshes of its own
    campaigns = {ladder.scene for ladder in LADDERS} | of_the_solid | of_the_experiment | others
    assert campaigns == set(SCENES) - ON_QUADS - MANY_SURFACES  # in no campaign
    for ladder in LADDERS:
        first = [int(mesh.split("x")[0]) for mesh in ladder.meshes]
        assert len(first) >= 3
        assert all(a < b for a, b in pairwise(first))


def test_cells_are_labelled_and_take_the_settings_of_an_element() -> None:
    made = ladder_cells({"element": "paper"}, "paper")
    assert len({cell.label for cell in made}) == len(made) == sum(len(ladder.meshes) for ladder in LADDERS)
    assert len({planned(cell).id for cell in made}) == len(made)
    other = ladder_cells({"thickness_strain": "nodal"}, "other")
    hemisphere = next(cell for cell in other if cell.label == "convergence hemisphere 32x32 other")
    assert hemisphere.settings == {"load_fraction": "1", "lines": "edges", "thickness_strain": "nodal"}
    assert [cell.label.rsplit(" ", 1)[0] for cell in other] == [cell.label.rsplit(" ", 1)[0] for cell in made]
    fewer = {cell.label for cell in ladder_cells({"element": "paper"}, "paper", finest=False)}
    left_out = {f"convergence {ladder.name} {ladder.meshes[-1]} paper" for ladder in LADDERS}
    instead = {f"convergence {ladder.name} {mesh} paper" for ladder in LADDERS for mesh in ladder.coarser}
    assert {cell.label for cell in made} - fewer == left_out
    assert fewer - {cell.label for cell in made} == instead


def _module(table: str) -> str:
    """That of the function which makes a table."""
    return str(resolve_name(MAKERS[table]).__module__)


@pytest.mark.parametrize(
    ("name", "beside"),
    [("problems", True), ("friction_crushed_ring", True), ("friction_public", False), ("choices", False)],
)
def test_data_decide_the_tables_that_are_made_of_them(name: str, beside: bool) -> None:
    """By the folder that they lie in, or alone with the module that names them, and with nothing else beside it."""
    module = _module(name)
    assert bool(data_of(module)) == beside
    if beside:
        return
    path = Path(str(sys.modules[module].__file__)).with_suffix(".csv")
    assert hashlib.sha256(path.read_bytes()).hexdigest() in hashed([module])[module]
    assert path not in data_of(_module("rigid_body")) + data_of(_module("friction_strip"))


def test_a_table_is_made_once_for_its_sources_and_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, sources = tmp_path / "shipped.csv", ["some"]
    data.write_text("x\n1\n")
    monkeypatch.setitem(MAKERS, "shipped", "")
    monkeypatch.setattr(worker, "resolve_name", lambda maker: lambda: pd.read_csv(data))
    monkeypatch.setattr(source_hash, "data_of", lambda module: [data])
    monkeypatch.setattr(source_hash, "sources_hash", lambda modules: sources[-1])
    for change in (lambda: None, lambda: data.write_text("x\n2\n"), lambda: sources.append("others")):
        change()
        assert make_table("shipped", tmp_path / "store")
        assert not make_table("shipped", tmp_path / "store")


def test_the_crushed_ring_with_friction_reads_a_file_of_the_scenes() -> None:
    names = {path.name for path in data_of(_module("friction_crushed_ring"))}
    assert "contact_crushed_ring.csv" in names
