"""``footprint bench solvers``: frozen contact problems before every solver, and whether two runs rank them alike."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import STORE, count, positive, progress_bar
from studies.output.terminal import columns

if TYPE_CHECKING:
    import pandas as pd

    from studies.arena.solver_run import Field

COUNTS = ("solver", "problems", "solved", "false", "refused", "timed_out")
ROUNDS, LIMIT_S, TOLERANCES = 3, 20.0, "1e-4,1e-6,1e-8"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A run, a comparison of two, or both."""
    parser.add_argument("--problems", type=Path, metavar="DIR", help="frozen steps (*.npz); without it nothing is run")
    parser.add_argument("--out", type=Path, default=STORE, metavar="STORE", help=f"default {STORE}")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"default {ROUNDS}")
    limit = f"processor time of a solve, default {LIMIT_S:g}"
    parser.add_argument("--limit", type=float, default=LIMIT_S, metavar="SECONDS", help=limit)
    parser.add_argument("--tolerance", default=TOLERANCES, metavar="T,...", help=f"default {TOLERANCES}")
    parser.add_argument("--only", action="append", default=[], metavar="SOLVER", help="one solver; as often as wanted")
    parser.add_argument("--ablation", action="store_true", help="the settings of OSQP, one at a time, instead")
    parser.add_argument("--against", type=Path, metavar="STORE", help="another run: do solvers rank alike?")
    parser.set_defaults(bench=bench)


def bench(options: argparse.Namespace) -> int:
    """Run what is missing, print the summary; compare."""
    from studies.arena.solver_run import FIELDS, against, problems_in, run, told

    field = FIELDS["osqp" if options.ablation else "solver"]
    if options.problems is not None:
        limit_s, rounds = positive("limit", options.limit), count("rounds", options.rounds)
        tolerances, problems = _tolerances(options.tolerance), problems_in(options.problems)
        asked = {"only": options.only, "tolerances": tolerances, "rounds": rounds, "limit_s": limit_s}
        with progress_bar("solvers") as advance:
            run(field, problems, options.out, tell=advance, **asked)
    elif options.against is None:
        raise UsageError("bench solvers needs --problems DIR, --against STORE, or both")
    print("\n".join(_summary(field, options.out, told(field, options.out)["limit_s"])))
    if options.against is None:
        return OK
    return _compared(against(field, options.out, options.against))


def _tolerances(text: str) -> tuple[float, ...]:
    try:
        found = tuple(float(word) for word in text.split(","))
    except ValueError:
        found = ()
    if not found or not all(0 < each < 1 for each in found) or len(set(found)) < len(found):
        raise UsageError(f"--tolerance {text!r} must be different numbers in (0, 1), separated by commas")
    return found


def _summary(field: Field, store: Path, limit_s: str) -> Iterator[str]:
    """A block a tolerance and kind of problem, all sizes together, best first."""
    import pandas as pd

    found = pd.read_csv(field.path(store, "summary"))
    yield f"failures at the limit of {float(limit_s):g} s; means of processor time, shifted by 0.01 s"
    heads = ("solver", "problems", "solved", "false", "refused", "timed out", "mean s", "MB")
    for (tolerance, kind), own in found[found["size"] == "all"].groupby(["tolerance", "kind"], sort=False):
        none = own["refused"] == own["problems"]
        best_first = own[~none].sort_values("mean_s", kind="stable").to_dict("records")
        counts = [[str(row[key]) for key in COUNTS] for row in best_first]
        means = [(f"{row['mean_s']:.4f}", f"{row['memory_MB']:.1f}") for row in best_first]
        rows = [(*own_counts, *own_means) for own_counts, own_means in zip(counts, means, strict=True)]
        yield from ("", f"{kind}, to {tolerance:g}", *columns([heads, *rows], right=range(1, 8)))
        if none.any():
            yield f"all {own['problems'].max()} refused by {'; '.join(own.loc[none, 'solver'])}"


def _compared(found: pd.DataFrame) -> int:
    """Print the correlations of ranks; FAILED where one is below the bar."""
    from studies.arena.solver_run import REPEATED

    heads = ("tolerance", "kind", "problems", "solvers", "Spearman", "Kendall", "")
    rows = []
    for row in found.to_dict("records"):
        none = math.isnan(row["spearman"])
        bar = "no ranks" if none else "repeats" if row["spearman"] >= REPEATED else "BROKEN"
        alike = (f"{row['spearman']:.3f}", f"{row['kendall']:.3f}", bar)
        rows.append((f"{row['tolerance']:g}", str(row["kind"]), str(row["problems"]), str(row["solvers"]), *alike))
    print(f"\nranks of two runs, Spearman's at least {REPEATED:g}")
    print("\n".join(columns([heads, *rows], right=range(2, 6))))
    return FAILED if any(row[-1] == "BROKEN" for row in rows) else OK
