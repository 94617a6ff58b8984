"""The page of the data: every cell and every answer as files beside the pages, what is in them, how to cite them."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.overview.outcomes import WORDS
from reports.markdown import Part, folded, joined, listing, machine, prose, table
from reports.origin import counted, machines, origin
from reports.store.tables import Store

DATA = "data"
TABLES = {"cells": "a row a cell of the plan, whatever became of it", "answers": "a row a quantity of a cell"}
NEEDED = tuple(f"data_{name}" for name in (*TABLES, "columns"))
AS_ASKED = ("converged", "unstable", "unsupported")


def data_files(store: Store) -> dict[str, str]:
    """The tables to be taken away as CSV, by file name; those of many rows are compressed when they are written."""
    names = {f"{DATA}/{name}.csv.gz": f"data_{name}" for name in TABLES} | {f"{DATA}/columns.csv": "data_columns"}
    return {
        file: store.analysis(name).drop(columns="campaign").to_csv(index=False, float_format="%.10g")
        for file, name in names.items()
    }


def data_page(store: Store) -> Part:
    """The whole page."""
    cells, answers, columns = (store.analysis(name) for name in NEEDED)
    counts = counted(store.planned)
    told = ", ".join(f"{count} {name}" for name, count in counts.items())
    introduction = prose(f"""# Data

{len(answers)} answers of {len(cells)} cells: {told}. They lie beside the pages as CSV, with a description of every
column.""")
    files = [[_link(f"{name}.csv.gz"), len(store.analysis(f"data_{name}")), words] for name, words in TABLES.items()]
    files.append([_link("columns.csv"), len(columns), "a row a column of the other two: its unit and what it is"])
    return joined(
        introduction,
        table("Files", ["file", "rows", "what it is"], files, words=3),
        _reading(),
        f"## Columns\n\n{_columns(columns.fillna(''))}",
        _completeness(store, counts),
        _citing(),
        origin(store),
        machines(store),
    )


def _link(name: str) -> str:
    return f"[{DATA}/{name}]({DATA}/{name})"


def _reading() -> str:
    return prose("""## How to read them

pandas, R and DuckDB read compressed CSV as it is; for a spreadsheet unpack it by `gunzip`. Numbers have ten digits,
seconds four; what does not exist is empty. Parquet is not written: pandas has it from a further package only, and
`answers.to_parquet("answers.parquet")` makes it where that is installed.""") + (
        '\n\n```python\nimport pandas as pd\n\ncells = pd.read_csv("data/cells.csv.gz")\n'
        'answers = pd.read_csv("data/answers.csv.gz").merge(cells, on="cell")\n'
        "tyre = answers.query(\"scene == 'tyre' and quantity == 'force_N'\")\n"
        'print(tyre.sort_values("seconds")[["measure", "contact", "mesh", "value", "error", "seconds"]])\n```'
    )


def _columns(columns: pd.DataFrame) -> str:
    line = "{column:code} | {unit:said} | {description}"
    each = (
        listing(f"{name}.csv", columns[columns["table"] == name], "column | unit | description", line, words=3)
        for name in TABLES
    )
    return "\n\n".join(each)


def _completeness(store: Store, counts: dict[str, int]) -> Part:
    """Cells by class, and those that did not go as asked."""
    rows = [[name, count, WORDS[name]] for name, count in counts.items()]
    rows.append(["all", sum(counts.values()), "cells of the plan"])
    parts = ["## Completeness", table("Cells by what became of them", ["class", "cells", "meaning"], rows, words=3)]
    failed = [each for each in store.planned if each.ended not in AS_ASKED]
    if failed:
        how = listing("How they ended", failed, "cell | class | reason", "{label} | {ended} | {reason}", words=3)
        parts.append(machine(folded(f"The {len(failed)} cells that did not go as asked", how)))
    return joined(*parts)


def _citing() -> str:
    return prose("""## Licence and citation

The data, the pages and the program are under the MIT licence: free to use, change and pass on, with its notice. To cite
them, name *The Footprint authors, Footprint: a verification and benchmark suite for shell strain measures and contact
algorithms*, its version and the commit that stands at the foot of every page; `.github/CITATION.cff` has it for
reference managers.""")


CHAPTER = Chapter(
    DATA,
    "Data",
    "every cell and every answer as CSV, with a description of the columns, licence and citation.",
    data_page,
    needs=NEEDED,
)
