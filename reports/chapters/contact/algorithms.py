"""The page of contact algorithms: do they agree, what do they cost, who claims too much, which ε, when not."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.contact.agreement import agreement_part
from reports.chapters.contact.arena import arena_part
from reports.chapters.contact.costs import USUAL, costs_part
from reports.chapters.contact.penalty import penalty_part
from reports.formats import scientific
from reports.markdown import Part, table
from reports.store.tables import Store
from reports.template import Template

EXACT = 1e-9  # an error below it is no error
ALONE = "alone"  # in the name of a solver that is taken at its word


def _error(error: float) -> str:
    return f"under {scientific(EXACT, 0)}" if error < EXACT else scientific(error, 0)


TEXT = Template("algorithms", error=_error)


def algorithms_page(store: Store) -> Part:
    """The whole page."""
    parts = {
        "agreement": agreement_part(store),
        "costs": costs_part(store),
        "claims": _claims(store),
        "cycles": _cycles(store),
        "penalty": penalty_part(store),
        "when_not": when_not_table(),
        "known": _known(store),
        "arena": arena_part(store),
    }
    return TEXT("page", **parts)


def _claims(store: Store) -> Part:
    """Who says that it has solved a problem, and has not."""
    found = store.table("false_success")
    alone = found["contender"].str.contains(ALONE)
    ours = found[~alone]
    told = {
        "problems": found["problems"].max(),
        "count": len(ours),
        "ours": "; ".join(map(_quoted, ours["contender"])),
        "claims": ours["claimed"].sum(),
        "wrong": ours["false"].sum(),
        "versions": ", ".join(sorted(set(found["version"].dropna()))),
    }
    return TEXT("claims", **told, alone=found[alone], arena=_in_the_arena(store))


def _quoted(way: str) -> str:
    name, comma, setting = way.partition(",")
    return f"`{name}`{comma}{setting}"


def _in_the_arena(store: Store) -> Part:
    """The false claims of the default algorithm on harder problems."""
    if not store.has_table("solver_summary"):
        return Part()
    found = store.table("solver_summary")
    strictest = found["tolerance"] == found["tolerance"].min()
    rows = found[(found["solver"] == USUAL) & (found["size"] == "all") & strictest]
    if rows.empty:
        return Part()
    sums = rows[["claimed", "problems", "false"]].sum()
    counts = {"claimed": sums["claimed"], "problems": sums["problems"], "wrong": sums["false"]}
    return TEXT("claims-in-the-arena", tolerance=rows["tolerance"].min(), **counts)


def _cycles(store: Store) -> str:
    """Sets that repeat themselves."""
    found = store.table("cycles")
    ways = list(found.columns[2:])
    rows = [
        [line["problem"], _period(line["plain_period"]), *(line[way] for way in ways)]
        for line in found.to_dict("records")
    ]
    header = ["problem", "textbook", *map(_quoted, ways)]
    return table("From the set that the textbook begins with", header, rows, words=len(header))


def _period(period: int) -> str:
    return f"cycles, period {period}" if period else "converged"


def when_not_table() -> Part:
    """What not to use, when, and why."""
    return TEXT("when-not")


def _known(store: Store) -> Part:
    """Contact of other bodies than shells, with known answers; older stores have none."""
    parts = {name: part(store) for name, part in (("membrane", _membrane), ("plate", _plate))}
    return TEXT("known", **parts) if any(map(str, parts.values())) else Part()


def _membrane(store: Store) -> Part:
    """A membrane over a sphere, whose contact radius is known."""
    if not store.has_table("membrane"):
        return Part()
    data = store.table("membrane")
    finest = data[data["level"] == data.groupby(["element", "algorithm"])["level"].transform("max")]
    counts = {"algorithms": data["algorithm"].nunique(), "apart": data["apart"].max()}
    return TEXT("membrane", **counts, finest=finest[finest["algorithm"] == USUAL])


def _plate(store: Store) -> Part:
    """The GRECO plate without friction."""
    if not store.has_table("greco_plate"):
        return Part()
    data = store.table("greco_plate")
    largest = {"error": data["pressure_error"].max(), "apart": data["apart"].max()}
    return TEXT("plate", algorithms=data["algorithm"].nunique(), **largest)


CHAPTER = Chapter(
    "algorithms",
    "Contact algorithms",
    'do they agree, what do they cost, which says "solved" and is wrong, which ε, when not, and public solvers.',
    algorithms_page,
    needs=("cycles", "false_success", "epsilon", "epsilon_laws"),
    always=True,
)
