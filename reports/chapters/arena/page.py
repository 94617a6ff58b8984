"""The arena: public solvers and our algorithms on frozen contact problems, and how to enter one's own.

A part of the page of contact algorithms; nothing is known here of paths of loads.
"""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from reports.chapters.arena.figures import profiles
from reports.formats import NOTHING, fixed, number, scientific, share
from reports.markdown import Part, commands, joined, machine, picture, prose, table
from reports.store.tables import Store

RUN = "footprint bench solvers --problems problems --out .footprint/store"
MAKE = "footprint problems make --out problems"
NEEDED = ("problems", "problems_left_out")
CONVEX, ALL = "convex", "all"
FORMS = ("scaled", "condensed")  # of the programme that a public solver is given
CYCLES, SIZE = "the contact set repeats itself", "too many"  # in what is said of a step that was left out
REASONS = {  # in what is said, the first that fits: why no answer is certified
    CYCLES: "`semismooth` cycles and its pivots do not settle it",
    "kernels of BLAS": "with other kernels of BLAS the path leads elsewhere",
    "singular": "the equations are singular to working precision",
    "presses other candidates": "the interior point finds another contact set",
    "wrong sign": "a force or gap has the wrong sign on the set that was found",
}
OTHER = "another condition of the certificate fails"
ROOM = "studies.arena.solvers"  # of the example below
ENTRY = """```python
# my_solver.py: public solvers of the arena are entries like this one
from dataclasses import dataclass
from {room}.base import Answer, Solver
from {room}.catalogue import SOLVERS


@dataclass(frozen=True)
class Mine(Solver):
    def answer(self, step, tolerance):  # step.K, r, G, gap, weights: K du + r = G' W p, g + G du >= 0, p >= 0
        du, pressure, claimed, iterations = my_method(step, tolerance)
        return Answer(du, pressure, claimed, iterations)


SOLVERS["mine"] = Mine("mine")
```

```sh
footprint card my_solver.py                     # judged beside ours in minutes; --check: exit 1 where a claim is false
footprint problems judge problems/NAME.npz answer.json   # any language: {"du": [...], "pressure": [...]}
```"""


def arena_part(store: Store) -> Part:
    """The whole part; nothing where the campaign has no collection."""
    if not all(map(store.has_table, NEEDED)):
        return Part("")
    ranked = "" if store.has_table("solver_summary") else f" `{RUN}` ranks public solvers on them, on this page."
    introduction = prose(f"""## The arena: public solvers on frozen problems

A *frozen problem* is one step of Newton's method of a shell, a solid or a published collection: stiffness, loads, gaps
and areas in a file. Every answer is judged from that file alone.{ranked}""")
    parts = (ranking_part, picture_part, osqp_part, entry_part, dropped_part, limits_part)
    return joined(introduction, *(part(store) for part in parts))


def ranking_part(store: Store) -> Part:
    """Who solves how many in which time, and who claims too much: a line a solver, in the form that suits it best."""
    if not store.has_table("solver_summary"):
        return Part("")
    found = store.table("solver_summary")
    every = found[(found["size"] == ALL) & (found["kind"] == CONVEX)]
    found = middle(found)
    whole = found[found["size"] == ALL]
    convex = whole[(whole["kind"] == CONVEX) & (whole["refused"] < whole["problems"])]
    others = whole[whole["kind"] != CONVEX].groupby("solver")[["problems", "solved", "refused", "false"]].sum()
    kinds = store.table("solver_problems")["kind"].value_counts()
    told = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    text = prose(f"""### Who solves how many?

{kinds.sum()} problems ({told}), asked for {scientific(found["tolerance"].iloc[0], 0)}. Solved: the solver claims it,
and imbalance, penetration, tension and complementarity are as small as asked; *false*: it claims it, and they are not.
What is not solved costs the time limit in the mean, geometric, shifted by 0.01 s, of processor time with set-up.
Public solvers get the programme in N and mm, *scaled* or *condensed* on the candidates; each stands here in the form
with most solutions, the last columns count its other forms. Problems that are not convex are no quadratic programmes:
those solvers refuse them. One linear problem is not a path of loads: what a path costs is
[above](#what-do-they-cost).""")
    strict = every[every["tolerance"] == every["tolerance"].min()].set_index("solver")
    heads = ["solver", "form", "convex: solved", "false", "killed", "mean [s]", "not convex: solved", "false"]
    heads += [f"convex, {scientific(every['tolerance'].min(), 0)}: solved", "false", "other forms: solved", "false"]
    made = table("Ranking", heads, list(_ranked(convex, others, strict)), words=2)
    return joined(text, machine(made))


def middle(found: pd.DataFrame) -> pd.DataFrame:
    """The rows of the middle tolerance."""
    asked = sorted(found["tolerance"].unique(), reverse=True)
    return found[found["tolerance"] == asked[len(asked) // 2]]


def _ranked(convex: pd.DataFrame, others: pd.DataFrame, strict: pd.DataFrame) -> Iterator[list[str]]:
    """Most solutions first, then the quickest; strict: the strictest tolerance, by solver."""
    parts = convex["solver"].str.rpartition(", ")
    formed = parts[2].isin(FORMS)
    named = convex.assign(bare=parts[0].where(formed, convex["solver"]), form=parts[2].where(formed, NOTHING))
    ordered = named.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable")
    for bare, own in ordered.groupby("bare", sort=False):
        best, rest = own.iloc[0], own.iloc[1:]
        beyond = ["refused", NOTHING]
        if best["solver"] in others.index:
            other = others.loc[best["solver"]]
            if other["refused"] < other["problems"]:
                beyond = [f"{other['solved']:.0f}/{other['problems']:.0f}", f"{other['false']:.0f}"]
        yield [
            *(str(bare), str(best["form"]), f"{best['solved']}/{best['problems']}", str(best["false"])),
            *(str(best["timed_out"]), fixed(best["mean_s"], 3), *beyond),
            *(str(strict.loc[best["solver"], name]) for name in ("solved", "false")),
            *(", ".join(map(str, rest[name])) or NOTHING for name in ("solved", "false")),
        ]


def picture_part(store: Store) -> Part:
    """Profiles at the middle tolerance."""
    if not store.has_table("solver_profiles"):
        return Part("")
    found = middle(store.table("solver_profiles"))
    own = found[(found["kind"] == CONVEX) & (found["size"] == ALL)]
    if own.empty:
        return Part("")
    text = prose("""Left the share of convex problems that a solver solves in at most so many times what the quickest
takes for each (Dolan, Moré, Math. Program. 91 (2002) 201-213), right within so many factorisations of the stiffness
(Moré, Wild, SIAM J. Optim. 20 (2009) 172-191). Problems that nobody solves count; the other solvers are grey.""")
    shown = picture("arena-profiles.svg", "Shares of convex problems solved over time, by solver", profiles(own))
    return joined(text, Part(machine(shown.text), shown.pictures))


def osqp_part(store: Store) -> Part:
    """Which setting of OSQP helps, and which harms."""
    if not store.has_table("osqp_effects"):
        return Part("")
    found = middle(store.table("osqp_effects"))
    own = found[(found["size"] == ALL) & (found["kind"] == CONVEX)]
    usual = own["setting"] == "defaults"
    if own[~usual].empty:
        return Part("")
    changed = own[~usual].sort_values(["more_solved", "time_ratio"], ascending=[False, True], kind="stable")
    told = [
        f"- {row['scale']}, {row['setting']}: {row['more_solved']:+.0f} solved, {row['more_false']:+.0f} false claims, "
        f"{fixed(row['time_ratio'], 2)} times the time"
        for row in pd.concat([changed.head(3), changed.tail(2)]).drop_duplicates().to_dict("records")
    ]
    text = prose(f"""### OSQP

One setting at a time against its defaults, on {own["problems"].max()} convex problems; of {len(changed)} changes the
three that gain and the two that lose most:""")
    return joined(text, machine("\n".join(told)))


def entry_part(store: Store) -> str:
    """Ten lines, and two commands."""
    return joined("### Enter your own", ENTRY.replace("{room}", ROOM)).text


def dropped_part(store: Store) -> Part:
    """What the rule would have taken and nobody certifies."""
    rows = store.table("problems_left_out")
    if rows.empty:
        return joined("### What was left out", "No step was left out for want of a certificate.")
    large = rows["why"].str.contains(SIZE)
    causes = rows.loc[~large, "why"].map(_cause)
    text = prose(f"""### What was left out of the collection

A step enters when its classes (size, candidates, share pressed, kind of matrix, coupling, condition) are new in its
family and two ways certify its answer. {len(rows)} steps were left out before: {large.sum()} for the size of their
file, {(~large).sum()} because no way certifies an answer. The rule so favours `semismooth`, which is tried first, but
not where it fails: in {(causes == REASONS[CYCLES]).sum()} steps it cycles, and whoever solves those is not rewarded
here.""")
    counted = [[why, count] for why, count in causes.value_counts(sort=True).items()]
    return joined(
        text, table("Not certified, because", ["reason of the first way", "steps"], counted), commands([MAKE])
    )


def _cause(why: str) -> str:
    first = why.split(";")[0]
    return next((words for part, words in REASONS.items() if part in first), OTHER)


def limits_part(store: Store) -> Part:
    """What bounds all this, and the machine."""
    if not store.has_table("solver_run"):
        return Part("")
    about = dict(store.table("solver_run").astype(str).itertuples(index=False, name=None))
    whole = store.table("solver_summary")
    asked = whole[whole["size"] == ALL]
    killed = share(float(asked["timed_out"].sum() / asked["problems"].sum()), 1)
    text = prose(f"""### Limits

A solve is killed after {number(float(about["limit_s"]))} s of processor time ({killed} of all that was to be solved).
The tolerance is handed to each solver for all that it can be asked for; what it is measured by differs, which is the
point of a common judge. Solvers keep their other defaults, but for the number of iterations. One thread.""")
    conditions = ", ".join(f"{name} {value}" for name, value in about.items() if name != "limit_s")
    return joined(text, machine(f"Run with {conditions}."), commands([RUN, f"{RUN} --ablation"]))
