"""The page of questions: what a reader of this report asks, and what users of other solvers ask in public."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.markdown import Part, joined, listing, machine, prose
from reports.store.statements import Said, statements
from reports.store.tables import Store

GITHUB = "https://github.com"


def questions_page(store: Store) -> Part:
    """The whole page."""
    known = {each.name: each for each in statements(store)}
    asks, readers = store.analysis("asks"), store.analysis("readers")
    answered = int(asks["answered"].sum())
    text = prose(f"""# Questions

{answered} of {len(asks)} questions that users of other solvers ask in public are answered by sentences that are
computed from this campaign, with the command that leads to such an answer. What cannot be answered says what is
missing. Names are links to the threads.""")
    own = [_question(row, known) for row in asks.to_dict("records")]
    return joined(text, "## What users ask", *own, _readers(readers.to_dict("records"), known))


def _question(row: dict, known: dict[str, Said]) -> Part:
    said = [known[name] for name in _names(row["answers"]) if name in known]
    asked = f"### {row['question']}\n\nAsked in {', '.join(map(_thread, row['threads'].split(', ')))}."
    steady = " ".join(each.text for each in said if not each.machine)
    timed = " ".join(each.text for each in said if each.machine)
    missing = row["missing"] if isinstance(row["missing"], str) else ""
    command = row["command"] if isinstance(row["command"], str) else ""
    blocks = [asked, prose(steady) if steady else "", machine(prose(timed)) if timed else ""]
    blocks += [f"`{command}`" if said and command else "", f"*Missing:* {missing}." if missing else ""]
    if not said and not missing:
        blocks.append("*Missing:* this campaign does not solve what the answer would rest on.")
    return joined(*blocks)


def _names(answers: object) -> list[str]:
    return answers.split(", ") if isinstance(answers, str) and answers else []


def _thread(name: str) -> str:
    """A link to a thread by repository and number; words that are none stay words."""
    repository, _, number = name.partition("#")
    return f"[{name}]({GITHUB}/{repository}/issues/{number})" if number.isdigit() else name


def _readers(rows: list[dict], known: dict[str, Said]) -> Part:
    """Ten questions and where the answers stand."""
    told = [
        {
            "question": row["question"],
            "answer": known[_names(row["answers"])[0]].text if _names(row["answers"]) else "not in this campaign",
            "page": f"[{row['page']}]({row['page']}.md)" if _names(row["answers"]) else "–",
        }
        for row in rows
    ]
    heads, line = "question | answer | where", "{question} | {answer} | {page}"
    text = prose("""## Ten questions of a reader

Each answer stands on the [first page](index.md), or on the page that it leads to.""")
    return joined(text, machine(listing("Questions and where the answers stand", told, heads, line, words=3)))


CHAPTER = Chapter(
    "questions",
    "Questions",
    "what users of other solvers ask, answered by computed sentences, and ten questions of a reader.",
    questions_page,
    needs=("statements", "statement_values", "asks", "readers"),
)
