"""The page of the arena: the collection of frozen problems, and public solvers and our algorithms on it.

A section is a function of the store, in the order of SECTIONS; one whose tables are missing says how to make them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.arena.collection import collection_part
from reports.chapters.arena.figures import profiles
from reports.formats import number, share
from reports.markdown import Part, commands, fold, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COMMAND = "footprint bench solvers --problems DIR --out .footprint/store"
CONVEX, ALL = "convex", "all"
SIZES = {"all": "all", "small": "below 1000", "medium": "1000 to 10,000", "large": "above"}
KINDS = {
    "convex": "convex quadratic programmes",
    "not convex": "a symmetric matrix that is not definite",
    "not symmetric": "no symmetric matrix, as of a follower load",
    "consistent coupling": "pressures that are no multipliers",
}
REPEATED = 0.95


def arena_page(store: Store) -> Part:
    """The whole page."""
    return joined(_introduction(), collection_part(store), _solver_table(store))


def _introduction() -> str:
    return prose("""# The arena

Others' algorithms, solvers and programs on our problems, judged from the files alone. A *frozen problem* is one
linearised contact problem of a shell, a solid or a published collection: stiffness, loads, gaps and areas. Whoever
reads the file may answer; `footprint problems judge` recomputes what the answer claims. `footprint card` judges an
algorithm, a strain measure or a solver of yours and writes one page about it; `footprint card --template` lays out a
repository that does so at every change.""")


def _solver_table(store: Store) -> Part:
    """All that is known of solvers, where they were put to the problems."""
    heading = "## Solvers on the collection"
    if not store.has_table("solver_summary"):
        return joined(heading, machine(f"Not measured here; `{COMMAND}` does, with the extra qp."))
    return joined(heading, _conditions(store), *(section(store) for section in SECTIONS))


def _conditions(store: Store) -> str:
    kinds = store.table("solver_problems")["kind"].value_counts()
    told = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    return prose(f"""{kinds.sum()} problems ({told}) are put to every solver in turn: to our algorithms,
from rest and without a first set, and to public solvers of quadratic programmes, each as it comes, once with the
programme in N and mm and once *scaled* (unit diagonal, unit rows, displacements about 1), some also *condensed* on
the candidates. What is not convex, not symmetric or coupled is no quadratic programme, and its solvers refuse it.

An answer is judged from the file alone: imbalance, penetration, tension and complementarity, each over a force or a
length that no answer can enlarge; the largest is its *accuracy*. It is a *solution* when the solver claims it and the
accuracy is what the solver was asked for. A claim that is less accurate is *false*. Whatever is no solution is a
failure, and costs the time limit in every mean: what is refused, killed, not claimed or falsely claimed.""")


def tolerances(found: pd.DataFrame) -> list[float]:
    """From loose to strict."""
    return sorted(found["tolerance"].unique(), reverse=True)


def _solvers(store: Store) -> Part:
    """Solutions and false claims of every solver by tolerance, kind after kind."""
    found = store.table("solver_summary")
    whole = found[found["size"] == ALL]
    blocks: list[Part | str] = [
        prose("""### Who solves what

Columns are what was asked for. *Worst claim* is the accuracy of the worst claim over what was asked; *own* counts
claims that do not even keep the solver's own criterion. Times are of the processor, set-up included; their mean is
geometric, shifted by 0.01 s. Memory is the median of the peaks of single solves.""")
    ]
    for kind in [kind for kind in KINDS if kind in set(whole["kind"])]:
        own = whole[whole["kind"] == kind]
        none = own.groupby("solver")["refused"].transform("min") >= own["problems"]
        refusing = own[none].drop_duplicates("solver")
        blocks += [f"#### {KINDS[kind].capitalize()}", machine(_counts(own[~none], kind), _times(own[~none]))]
        if len(refusing):
            line = "{solver} | {problems} | {why_not}"
            heads = "solver | problems | commonest reason"
            blocks.append(
                fold(f"{len(refusing)} solvers refuse all of them", listing("Refused", refusing, heads, line))
            )
    return joined(*blocks)


def _counts(own: pd.DataFrame, kind: str) -> str:
    """Problems, solutions and false claims by tolerance."""
    asked = tolerances(own)
    header = [
        "solver",
        "problems",
        *(f"solved, {each:.0e}" for each in asked),
        *(f"false, {each:.0e}" for each in asked),
    ]
    rows = [
        [solver, rows["problems"].max(), *_each(rows, asked, "solved"), *_each(rows, asked, "false")]
        for solver, rows in _by_solved(own)
    ]
    return table(f"Solutions and false claims, {KINDS[kind]}", header, rows)


def _times(own: pd.DataFrame) -> str:
    """What becomes of the strictest tolerance."""
    strict = own[own["tolerance"] == own["tolerance"].min()]
    heads = "solver | problems | failed, at the limit | refused | timed out | false | tenfold | own | worst claim | "
    heads += "mean [s] | memory [MB]"
    line = "{solver} | {problems} | {failed_at_limit} | {refused} | {timed_out} | {false} | {false_tenfold} | "
    line += "{false_own} | {worst_claim:.1e} | {mean_s:.3f} | {memory_MB:.1f}"
    ordered = strict.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable")
    return listing(f"Asked for {strict['tolerance'].min():.0e}: failures, false claims, costs", ordered, heads, line)


def _by_solved(own: pd.DataFrame) -> Iterable[tuple[Any, pd.DataFrame]]:
    """Rows of each solver, most solutions first."""
    order = own.groupby("solver", sort=False)["solved"].sum().sort_values(ascending=False, kind="stable").index
    return ((solver, own[own["solver"] == solver]) for solver in order)


def _each(rows: pd.DataFrame, asked: list[float], column: str) -> list[object]:
    known = rows.set_index("tolerance")[column]
    return [known.get(each, "–") for each in asked]


def _profiles(store: Store) -> Part:
    """The figure, at the middle tolerance."""
    found = store.table("solver_profiles")
    middle = tolerances(found)[len(found["tolerance"].unique()) // 2]
    own = found[(found["kind"] == CONVEX) & (found["size"] == ALL) & (found["tolerance"] == middle)]
    if own.empty:
        return Part("")
    text = prose(f"""### Profiles

On the {own["problems"].iloc[0]} convex problems, asked for {middle:.0e}: left the share of problems that a solver
solves in at most so many times what the quickest takes for each (Dolan, Moré, Math. Program. 91 (2002) 201-213),
right within so many factorisations of the stiffness (Moré, Wild, SIAM J. Optim. 20 (2009) 172-191). No curve rises
above the share that is solved at all; problems that nobody solves count. Nine solvers with the largest areas are
named, the others are grey. A profile depends on who is in it.""")
    shown = picture(
        "arena-profiles.svg", "Performance and data profiles of the solvers on convex problems", profiles(own)
    )
    return joined(text, Part(machine(shown.text), shown.pictures))


def _sizes(store: Store) -> Part:
    """Solved shares by size of convex problems, and by kind."""
    found = store.table("solver_summary")
    middle = tolerances(found)[len(found["tolerance"].unique()) // 2]
    own = found[found["tolerance"] == middle]
    convex = own[own["kind"] == CONVEX]
    text = prose(f"""### By size and kind

Solutions of so many problems, and the shifted mean in seconds, asked for {middle:.0e}; sizes are numbers of
unknowns.""")
    by_size = _cross(f"Convex problems by size, {middle:.0e}", convex, "size", SIZES)
    whole = own[own["size"] == ALL]
    by_kind = _cross(f"All problems by kind, {middle:.0e}", whole, "kind", {kind: kind for kind in KINDS})
    return joined(text, machine(by_size, by_kind))


def _cross(title: str, found: pd.DataFrame, column: str, names: dict[str, str]) -> str:
    """Solver by what is in a column."""
    there = [name for name in names if name in set(found[column])]
    rows = []
    for solver, own in _by_solved(found):
        known = {row[column]: row for row in own.to_dict("records")}
        rows.append([solver, *(_cell(known.get(name)) for name in there)])
    return table(title, ["solver", *(names[name] for name in there)], rows)


def _cell(row: dict[Any, Any] | None) -> str:
    if row is None:
        return "–"
    return "refused" if row["refused"] == row["problems"] else f"{row['solved']}/{row['problems']}, {row['mean_s']:.3f}"


def _ablation(store: Store) -> Part:
    """What each setting of OSQP is worth."""
    heading = "### OSQP, setting by setting"
    if not store.has_table("osqp_effects"):
        return joined(heading, machine(f"Not measured here; `{COMMAND} --ablation` does."))
    found = store.table("osqp_effects")
    middle = tolerances(found)[len(found["tolerance"].unique()) // 2]
    own = found[(found["tolerance"] == middle) & (found["size"] == ALL) & (found["kind"] == CONVEX)]
    text = prose(f"""One setting at a time is another than by default, asked for {middle:.0e}; *times* is the shifted
mean over that of the defaults on the same scale, below 1 where the setting is quicker. Algebras other than the builtin
one, with which OSQP solves the reduced system by conjugate gradients, come with other wheels and are refused without
them. A warm start sets out from the exact answer of 0.99 of loads and gaps.""")
    heads = "programme | setting | problems | solved more | false more | mean [s] | times"
    line = "{scale} | {setting} | {problems} | {more_solved:+.0f} | {more_false:+.0f} | {mean_s:.3f} | {time_ratio:.2f}"
    made = listing(f"Against the defaults, convex problems, {middle:.0e}", own, heads, line, words=2)
    return joined(heading, text, machine(made))


def _limits(store: Store) -> Part:
    """What bounds all this, and the machine."""
    run = store.table("solver_run").astype(str)
    about = dict(run.itertuples(index=False, name=None))
    whole = store.table("solver_summary")
    asked = whole[whole["size"] == ALL]
    killed = share(float(asked["timed_out"].sum() / asked["problems"].sum()), 1)
    text = prose(f"""### Limits and machine

A solve is killed after {number(float(about["limit_s"]))} s of processor time ({killed} of all that was to be solved),
so that shares of large problems are shares within that limit. Who was killed over a tolerance is not asked for a
stricter one of the same problem, which counts as killed. The tolerance is handed to each solver for all that it can be
asked for; what it is measured by differs from solver to solver, which is the point of a common judge. Solvers keep
their other defaults, but for the number of iterations. One thread.""")
    rows = [[name, value] for name, value in about.items()]
    against = f"{COMMAND.replace('DIR', 'problems')} --against OTHER_STORE"
    repeat = prose(f"""Two runs say the same when the ranks of the solvers by their means correlate (Spearman) by at
least {REPEATED}; `--against` compares them.""")
    listed = machine(table("Conditions of the run", ["what", "value"], rows, words=2))
    return joined(text, repeat, listed, commands([COMMAND, f"{COMMAND} --ablation", against]))


SECTIONS: tuple[Callable[[Store], Part], ...] = (_solvers, _profiles, _sizes, _ablation, _limits)

CHAPTER = Chapter(
    "arena",
    "The arena",
    "a collection of frozen contact problems, public solvers and our algorithms on it, and how to enter one's own.",
    arena_page,
    needs=("problems", "problems_left_out"),
)
