"""Measures and algorithms that nobody has heard of, through every page and every figure."""

from __future__ import annotations

import copy
import json
import os
import shutil
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from reports.contents import CHAPTERS
from reports.figures.drawing import KNOWN, looks
from reports.html import REPORT
from reports.site import rendered
from reports.store import load_store
from studies.analysis.everything import analysed
from studies.analysis.outcomes import contact_summary, outcomes
from studies.output.atomic import write_json, write_table
from support.stores.sweeps import cells

MEASURES = tuple(f"made-up-{number}" for number in range(1, 12))
ALGORITHMS = tuple(f"invented-{number}" for number in range(1, 10))
KNOWN_AS = {"measure": "exact", "algorithm": "semismooth", "contact": "semismooth", "contender": "lcp"}  # by column
EXTENDED = (  # tables in which a measure or an algorithm has rows of its own
    *(
        "rigid_body",
        "small_motions",
        "rotation_sweep",
        "rotations",
        "symmetry",
        "mirror",
        "false_success",
        "contact_summary",
        "outcomes",
        "membrane",
        "greco_plate",
    ),
    "choices",
    "measure_limits",
)
Names = tuple[str, ...]


def extended(table: pd.DataFrame, measures: Names, algorithms: Names) -> pd.DataFrame:
    """The rows of one known measure or algorithm again under each made-up name."""
    parts = [table]
    for column, known in KNOWN_AS.items():
        if column in table:
            names = measures if column == "measure" else algorithms
            own = table[table[column] == (known if (table[column] == known).any() else "linear")]
            parts += [own.assign(**{column: name}) for name in names]
    if "row" in table:  # of choices: both kinds in one column
        for axis, known, names in (("measure", "linear", measures), ("algorithm", "lcp", algorithms)):
            parts += [table[(table["axis"] == axis) & (table["name"] == known)].assign(name=name) for name in names]
    return pd.concat(parts, ignore_index=True)


def copied(row: dict[str, Any], record: dict[str, Any], key: str, name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """A row of the index and its record as another measure or algorithm would have them."""
    row, record, old = copy.deepcopy(row), copy.deepcopy(record), str(record[key])
    row |= {"label": row["label"].replace(old, name), "id": f"{row['id']}-{name}"}
    row["request"][key] = record[key] = name
    record["id"] = row["id"]
    return row, record


def all_pages(root: Path, measures: Names, algorithms: Names, draw: bool) -> dict[str, str]:
    """Every page, of a store that is changed to one in which the catalogues are longer by these."""
    index = json.loads((root / "campaigns/report.json").read_text())
    for row in list(index["cells"]):
        path = root / "cells" / f"{row['id']}.json"
        record = json.loads(path.read_text())
        copies = []
        if row["label"].startswith("agreement trial-and-error "):
            copies = [copied(row, record, "contact", name) for name in algorithms]
        for new, its in copies:
            index["cells"].append(new)
            write_json(root / "cells" / f"{new['id']}.json", its)
            shutil.copytree(path.with_suffix(""), root / "cells" / new["id"], copy_function=os.link)
    write_json(root / "campaigns/report.json", index)
    sweep = pd.concat(
        [
            cells(measures={"exact": 0.0, "linear": 0.03}, contacts={"semismooth": 1.0, "lcp": 2.0}),
            cells("hemisphere", "inward_mm", 8.178, contacts={"semismooth": 1.0, "lcp": 2.0}),
        ],
        ignore_index=True,
    )
    tables = {"outcomes": outcomes(sweep), "contact_summary": contact_summary(sweep)}
    for name, table in {**analysed(sweep), **tables}.items():
        write_table(root / "tables" / f"{name}.csv", table.assign(campaign="report"))
    for path in (root / "tables" / f"{name}.csv" for name in EXTENDED):
        if path.exists():
            write_table(path, extended(pd.read_csv(path), measures, algorithms))
    return rendered(load_store(root), draw=draw)


@pytest.mark.slow
@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(("all_of_them", "draw"), [(False, False), (True, True)])
def test_every_page_takes_made_up_measures_and_algorithms(all_of_them: bool, draw: bool, own_store: Path) -> None:
    """None is dropped: each is on the pages of its kind, by name."""
    measures, algorithms = (names if all_of_them else names[:2] for names in (MEASURES, ALGORITHMS))
    files = all_pages(own_store, measures, algorithms, draw)
    assert {each.file for each in CHAPTERS} | {"index.md", REPORT} <= set(files)
    for page in ("measures.md", "invariance.md", "index.md"):
        assert [name for name in measures if name not in files[page]] == [], page
    for page in ("algorithms.md", "data.md"):  # page one draws them
        assert [name for name in algorithms if name not in files[page]] == [], page


def test_a_look_is_one_for_all_figures_and_never_runs_out() -> None:
    for known in KNOWN:
        whole = looks([*known, *MEASURES])
        assert {name: whole[name] for name in known} == looks(known)
        assert looks(reversed(known)) == looks(known)
        assert looks([known[3]])[known[3]] == whole[known[3]]
    names = [*KNOWN[0], *MEASURES]
    drawn = looks(names)
    assert len(drawn) == 20
    assert len({(each.colour, each.marker) for each in drawn.values()}) == 20
    assert len({(each.colour, each.line) for each in drawn.values()}) == 20
    assert len({each.colour for each in looks(KNOWN[0]).values()}) == len(KNOWN[0])
    assert len(looks(range(100))) == 100
    ours = looks([name for known in KNOWN for name in known])  # no algorithm looks like a measure
    assert len({(each.colour, each.marker) for each in ours.values()}) == len(ours)
    assert ours["semismooth"] == looks(["semismooth"])["semismooth"]


def test_known_names_are_those_of_the_catalogues() -> None:
    from contact.catalogue import ALGORITHMS as OURS
    from formulations.strains.catalogue import MEASURES as STRAINS

    assert (tuple(STRAINS), tuple(OURS)) == KNOWN


@pytest.mark.parametrize("names", KNOWN)
def test_a_name_has_its_look_alone_or_among_others(names: tuple[str, ...]) -> None:
    for name in names:
        assert looks([name, "zz"])[name] == looks(names)[name]
