"""The page of contact algorithms: do they agree, what do they cost, who claims too much, which ε, when not."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.chapters.arena.page import arena_part
from reports.chapters.contact.agreement import agreement_part
from reports.chapters.contact.costs import USUAL, costs_part
from reports.chapters.contact.penalty import penalty_part
from reports.formats import scientific
from reports.markdown import Part, joined, listing, machine, prose, table
from reports.store.tables import Store

EXACT = 1e-9  # an error below it is no error
ALONE = "alone"  # in the name of a solver that is taken at its word
WHEN_NOT = (  # what, when not, and why
    (
        "`semismooth`",
        "alone where a result is called unstable",
        "on an indefinite tangent pivots need not settle its cycles",
    ),
    ("`trial-and-error`", "on fine meshes", "every set is solved to the end, and patches of more nodes take more sets"),
    ("`regularised`", "where contact or friction must be exact", "the wall penetrates by p/ε"),
    (
        "`augmented-lagrangian`",
        "where exact contact can be had at once",
        "it takes no fewer iterations; its use is in a penalty code",
    ),
    ("`qp`", "with follower loads or non-symmetric sections", "without an energy it refuses"),
    ("`lcp`", "where thousands of nodes change at once", "it pivots on a dense system of the misplaced candidates"),
    (
        "OSQP alone",
        "without a judge",
        "its tolerance is no bound on displacements; ask for 1e-8 with polishing, in scaled units",
    ),
)


def algorithms_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose("""# Contact algorithms

Every algorithm solves the same equations and is judged by the same judge, which recomputes equilibrium, gaps and
pressures and trusts no algorithm. Failures over all scenes are in the [appendix](data.md#solved-failed-refused);
linear problems, with public solvers beside ours, [below](#the-arena-public-solvers-on-frozen-problems); friction
[has a page of its own](friction.md).""")
    parts = (agreement_part, costs_part, claims_part, cycles_part, penalty_part, when_not_part, known_part, arena_part)
    return joined(introduction, *(part(store) for part in parts))


def claims_part(store: Store) -> Part:
    """Who says that it has solved a problem, and has not."""
    found = store.table("false_success")
    names = ("version", "worst", "worst_fails")
    found = found.assign(**{name: found[name].astype(object).where(found[name].notna(), "") for name in names})
    alone = found["contender"].str.contains(ALONE)
    ours = found[~alone]
    versions = ", ".join(sorted(set(found["version"]) - {""}))
    text = prose(f"""## Who says "solved" and is wrong?

{found["problems"].max()} small problems: published obstacle problems, classics of linear complementarity and linearised
steps of shells. An answer that is called solved is judged twice: by the tolerance that the solver was asked for, in its
own criterion, and by the judge of contact. Our {len(ours)} algorithms and settings
({"; ".join(map(_quoted, ours["contender"]))}) make {ours["claimed"].sum()} claims, of which {ours["false"].sum()} are
false. Solvers of quadratic programmes *alone* are taken at their word. Versions: {versions}.""")
    heads = "solver | asked for | claims | false by its own criterion | false by the judge | "
    heads += "largest error of a displacement | where | which condition fails"
    line = "{contender} | {tolerance:.0e} | {claimed} of {problems} | {false_own} | {false} | {largest_error:error} | "
    line += "{worst} | {worst_fails:said}"
    made = listing("Claims of solvers alone", found[alone], heads, line, error=_error)
    return joined(text, made, _in_the_arena(store))


def _error(error: float) -> str:
    return f"under {scientific(EXACT, 0)}" if error < EXACT else scientific(error, 0)


def _quoted(way: str) -> str:
    name, comma, setting = way.partition(",")
    return f"`{name}`{comma}{setting}"


def _in_the_arena(store: Store) -> str:
    """The false claims of the default algorithm on harder problems."""
    if not store.has_table("solver_summary"):
        return ""
    found = store.table("solver_summary")
    strictest = found["tolerance"] == found["tolerance"].min()
    rows = found[(found["solver"] == USUAL) & (found["size"] == "all") & strictest]
    if rows.empty:
        return ""
    return machine(
        prose(f"""The [arena](#the-arena-public-solvers-on-frozen-problems) is harder: of
{rows["claimed"].sum()} claims of `{USUAL}` to
{scientific(rows["tolerance"].min(), 0)} on {rows["problems"].sum()} problems there {rows["false"].sum()} are
false. It has public solvers in all their forms, and what the settings of OSQP are worth.""")
    )


def cycles_part(store: Store) -> Part:
    """Sets that repeat themselves."""
    found = store.table("cycles")
    ways = list(found.columns[2:])
    text = prose("""## Where does the paper's active set cycle?

The textbook's active set, which is the paper's, swaps all violating nodes at once, and on published problems returns to
a set that it has had. No rule that does so is finite: the smallest counterexample has three unknowns and a symmetric
positive definite matrix (3x3; Curtis, Han and Robinson, 2015). Our `trial-and-error` detects a set that returns and
solves the linearised problem by principal pivots, which is finite for every P-matrix (Cottle, Pang and Stone, 1992):
wherever the tangent is definite on the motions that contact leaves free, and contact is lumped. For an indefinite
tangent there is no such theorem.""")
    rows = [
        [line["problem"], _period(line["plain_period"]), *(line[way] for way in ways)]
        for line in found.to_dict("records")
    ]
    header = ["problem", "textbook", *map(_quoted, ways)]
    return joined(text, table("From the set that the textbook begins with", header, rows, words=len(header)))


def _period(period: int) -> str:
    return f"cycles, period {period}" if period else "converged"


def when_not_part(store: Store) -> Part:
    """Advice that follows from the parts above."""
    return joined("## When not to use each", when_not_table())


def when_not_table() -> str:
    """What not to use, when, and why."""
    return table("Do not use", ["what", "when", "why"], WHEN_NOT, words=3)


def known_part(store: Store) -> Part:
    """Contact of other bodies than shells, with known answers; older stores have none."""
    blocks = [part(store) for name, part in KNOWN.items() if store.has_table(name)]
    return joined("## Bodies that are no shells", *blocks) if blocks else Part("")


def _membrane(store: Store) -> Part:
    """A membrane over a sphere, whose contact radius is known."""
    data = store.table("membrane")
    finest = data[data["level"] == data.groupby(["element", "algorithm"])["level"].transform("max")]
    own = finest[finest["algorithm"] == USUAL]
    text = prose(f"""A membrane over half a sphere (example 36 of MFEM) has closed forms. Theory: orders 2 in L2 and 1
in the energy (H1) for linear elements, 3/2 in the energy for quadratic ones, as the second derivative jumps on the rim.
The deflections of {data["algorithm"].nunique()} algorithms differ by at most {scientific(float(data["apart"].max()))}
of the largest one.""")
    heads = "element | unknowns | error of the force | of the contact radius | order, L2 | order, H1"
    line = "{element} | {unknowns} | {force:.1e} | {radius:.1e} | {order_l2:.2f} | {order_h1:.2f}"
    return joined(text, listing(f"A membrane over a sphere, finest meshes, `{USUAL}`", own, heads, line))


def _plate(store: Store) -> Part:
    """The GRECO plate without friction."""
    data = store.table("greco_plate")
    return Part(
        prose(f"""The GRECO plate without friction, under a uniform load, must carry 50 MPa everywhere on its bottom:
{data["algorithm"].nunique()} algorithms miss that by at most {scientific(float(data["pressure_error"].max()))} of it,
and their deflections differ by at most {scientific(float(data["apart"].max()))} of the largest one.""")
    )


KNOWN = {"membrane": _membrane, "greco_plate": _plate}

CHAPTER = Chapter(
    "algorithms",
    "Contact algorithms",
    'do they agree, what do they cost, which says "solved" and is wrong, which ε, when not, and public solvers.',
    algorithms_page,
    needs=("cycles", "false_success", "epsilon", "epsilon_laws"),
    always=True,
)
