"""The appendix: outcomes, questions, findings, words, and every cell and answer as files beside the pages."""

from __future__ import annotations

from collections.abc import Iterator

from reports.chapter import ALL, Chapter
from reports.chapters.answers.findings import findings_part
from reports.chapters.answers.glossary import words_part
from reports.chapters.answers.questions import questions_part
from reports.chapters.overview.solved import outcomes_part
from reports.markdown import Part, folded, joined, listing, machine, prose, table
from reports.origin import machines, origin
from reports.store.tables import Store

DATA = "data"
TABLES = {"cells": "a row a cell of the plan, whatever became of it", "answers": "a row a quantity of a cell"}
NEEDED = tuple(f"data_{name}" for name in (*TABLES, "columns"))
AS_ASKED = ("converged", "unstable", "unsupported")


def data_files(store: Store) -> dict[str, str]:
    """The tables to be taken away as CSV, by file name; those of many rows are compressed when they are written."""
    names = {f"{DATA}/{name}.csv.gz": f"data_{name}" for name in TABLES} | {f"{DATA}/columns.csv": "data_columns"}
    names |= {f"{DATA}/claims.csv": "claims"} if _has_claims(store) else {}
    return {
        file: store.analysis(name).drop(columns="campaign").to_csv(index=False, float_format="%.10g")
        for file, name in names.items()
    }


def appendix(store: Store) -> Part:
    """The whole page."""
    head = prose("""# Appendix

Outcomes of the campaign, questions, all sentences of conclusion with their scope, words, and the data as files.""")
    parts = outcomes_part(store), questions_part(store), findings_part(store), words_part()
    return joined(head, *parts, *_data(store), origin(store), machines(store))


def _data(store: Store) -> Iterator[Part | str]:
    """The files, how to read and to cite them."""
    cells, answers, columns = (store.analysis(name) for name in NEEDED)
    text = f"""## Data

{len(answers)} answers of {len(cells)} cells lie beside the pages as CSV, with a description of every column."""
    files = [[_link(f"{name}.csv.gz"), len(store.analysis(f"data_{name}")), words] for name, words in TABLES.items()]
    files.append([_link("columns.csv"), len(columns), "a row a column of the other two: its unit and what it is"])
    if _has_claims(store):
        files.append([_link("claims.csv"), len(store.analysis("claims")), "a row a claim: status, interval, command"])
    yield prose(text)
    yield table("Files", ["file", "rows", "what it is"], files, words=3)
    yield _reading()
    yield _failed(store)
    yield _citing()


def _has_claims(store: Store) -> bool:
    """A part of the report has too few tables to judge them."""
    return store.pages == ALL and store.has_analysis("claims")


def _link(name: str) -> str:
    return f"[{DATA}/{name}]({DATA}/{name})"


def _reading() -> str:
    text = prose("""pandas, R and DuckDB read compressed CSV as it is; for a spreadsheet unpack it by `gunzip`. Numbers
have ten digits, seconds four; what does not exist is empty.""")
    return (
        f'{text}\n\n```python\nimport pandas as pd\n\ncells = pd.read_csv("data/cells.csv.gz")\n'
        'answers = pd.read_csv("data/answers.csv.gz").merge(cells, on="cell")\n'
        "tyre = answers.query(\"scene == 'tyre' and quantity == 'force_N'\")\n"
        'print(tyre.sort_values("seconds")[["measure", "contact", "mesh", "value", "error", "seconds"]])\n```'
    )


def _failed(store: Store) -> str:
    """The cells that did not go as asked, and why."""
    failed = [each for each in store.planned if each.ended not in AS_ASKED]
    if not failed:
        return ""
    how = listing("Why", failed, "cell | class | reason", "{label} | {ended} | {reason}", words=3)
    return machine(folded(f"The {len(failed)} cells that did not go as asked", how))


def _citing() -> str:
    return prose("""## Licence and citation

The data, the pages and the program are under the MIT licence: free to use, change and pass on, with its notice. To cite
them, name *The Footprint authors, Footprint: a verification and benchmark suite for shell strain measures and contact
algorithms*, its version and the commit that stands at the foot of every page; `.github/CITATION.cff` has it for
reference managers.""")


CHAPTER = Chapter(
    DATA,
    "Appendix",
    "outcomes by algorithm and measure, questions of users, all findings with their scope, words, data as CSV.",
    appendix,
    needs=NEEDED,
)
