"""``footprint bench solvers``: who solves frozen contact problems, and how well; ``leaderboard``: results as a page.

How an answer is asked for, timed and judged is in :mod:`studies.arena`.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studies.ask.request import UsageError
from studies.commands import FAILED, OK
from studies.commands.options import STORE, check_directory, count, positive, progress_bar

if TYPE_CHECKING:
    import pandas as pd

    from studies.arena.solver_run import Field
    from studies.arena.solver_table import Tell

SUMMED = {name: name for name in ("solver", "problems", "solved", "false", "refused")}
SUMMED |= {"timed_out": "timed out", "mean_s": "mean s", "memory_MB": "MB"}  # columns by what they are shown as
SOLVER_ROUNDS, LIMIT_S, TOLERANCES = 3, 20.0, "1e-4,1e-6,1e-8"


def add_solvers(parser: argparse.ArgumentParser) -> None:
    """A run, a comparison of two, or both."""
    parser.add_argument(
        "--problems", type=Path, metavar="DIR", help="frozen problems (*.npz); without it and --held-out no solver runs"
    )
    parser.add_argument("--out", type=Path, default=STORE, metavar="STORE", help="directory of results and tables")
    parser.add_argument("--rounds", type=int, default=SOLVER_ROUNDS, help="solves of each problem")
    limit = f"processor time of a solve, default {LIMIT_S:g}"
    parser.add_argument("--limit", type=float, default=LIMIT_S, metavar="SECONDS", help=limit)
    parser.add_argument("--tolerance", default=TOLERANCES, metavar="T,...", help="tolerances to request of the solvers")
    parser.add_argument("--only", action="append", default=[], metavar="SOLVER", help="one solver; may be repeated")
    parser.add_argument("--ablation", action="store_true", help="vary the settings of OSQP one at a time instead")
    drawn = "problems drawn from the secret in FILE, or in FOOTPRINT_ARENA_SECRET; never written to disk"
    parser.add_argument("--held-out", type=Path, nargs="?", const=Path(), metavar="FILE", help=drawn)
    handed = "write what each solver has done on the collection, a JSON each, for footprint leaderboard"
    parser.add_argument("--results", type=Path, metavar="DIR", help=handed)
    parser.add_argument("--against", type=Path, metavar="STORE", help="another run: compare the ranking of the solvers")
    parser.add_argument("--use", action="append", metavar="FILE.py", help="load your own solvers")
    parser.set_defaults(bench=_solvers)


def _solvers(options: argparse.Namespace) -> int:
    """Run what is missing, print the summary; compare."""
    from studies.arena.solver_run import FIELDS, against, told

    field = FIELDS["osqp" if options.ablation else "solver"]
    asks = options.problems is not None or options.held_out is not None
    if options.ablation and (options.results is not None or options.held_out is not None):
        raise UsageError("--results and --held-out do not apply to --ablation")
    if options.results is not None and not asks:
        raise UsageError("--results needs --problems DIR, --held-out, or both")
    if asks:
        with progress_bar("solvers") as advance:
            field = _run(field, options, advance)
    elif options.against is None:
        raise UsageError("bench solvers needs --problems DIR, --held-out, --against STORE, or several")
    print("\n".join(_solver_summary(field, options.out, told(field, options.out)["limit_s"])))
    if options.against is None:
        return OK
    return _ranks_compared(against(field, options.out, options.against))


def _run(field: Field, options: argparse.Namespace, tell: Tell) -> Field:
    """All that is asked for, and the results; returns the field whose summary is shown."""
    from studies.arena import held_out
    from studies.arena.solver_run import problems_in, run

    limit_s, tolerances = positive("limit", options.limit), _tolerances(options.tolerance)
    asked = {"only": options.only, "tolerances": tolerances, "rounds": count("rounds", options.rounds)}
    asked |= {"limit_s": limit_s, "tell": tell}
    key = None
    if options.held_out is not None:
        key = held_out.secret(None if options.held_out == Path() else options.held_out)
    problems = None if options.problems is None else problems_in(options.problems)
    if options.results is not None:
        check_directory(options.results)
        collection = _of_collection(options.problems, problems or {})
    tables, shown = {}, field
    if problems is not None:
        tables["public"] = run(field, problems, options.out, **asked)
    if key is not None:
        drawn = replace(field, name="held_out", further=lambda table, summed: {})
        tables["held_out"] = run(drawn, held_out.problems(key), options.out, **asked)
        shown = field if problems is not None else drawn
    if options.results is not None:
        _hand_in(options.results, tables, limit_s, collection, "" if key is None else held_out.digest(key))
    return shown


def _of_collection(folder: Path | None, problems: Mapping[str, Any]) -> list[str]:
    """Names of the collection without friction; raises UsageError where a file of the folder is another problem."""
    from studies.arena.collected.rule import STEPS

    kept = STEPS.manifest()
    if folder is not None:
        if not set(problems) & set(kept["name"]):
            raise UsageError(f"--results is of the collection, of which --problems {folder} has no file")
        wrong = STEPS.unlike(folder, kept[kept["name"].isin(problems)])
        if wrong:
            raise UsageError(f"--results is of the collection: {wrong[0]}")
    return list(kept["name"])


def _hand_in(
    folder: Path, tables: Mapping[str, pd.DataFrame], limit_s: float, collection: Sequence[str], secret: str
) -> None:
    from studies.arena.results import results_of

    written = [result.write(folder) for result in results_of(tables, limit_s, collection, secret)]
    print(f"{len(written)} results: {folder}")


def _tolerances(text: str) -> tuple[float, ...]:
    try:
        tolerances = tuple(float(word) for word in text.split(","))
    except ValueError:
        tolerances = ()
    if not tolerances or not all(0 < each < 1 for each in tolerances) or len(set(tolerances)) < len(tolerances):
        raise UsageError(f"--tolerance {text!r} must be different numbers in (0, 1), separated by commas")
    return tolerances


def _solver_summary(field: Field, store: Path, limit_s: str) -> Iterator[str]:
    """A block a tolerance and kind of problem, all sizes together, best first."""
    import pandas as pd

    summary = pd.read_csv(field.path(store, "summary"))
    yield f"failures at the limit of {float(limit_s):g} s; means of processor time, shifted by 0.01 s"
    for (tolerance, kind), own in summary[summary["size"] == "all"].groupby(["tolerance", "kind"], sort=False):
        none = own["refused"] == own["problems"]
        best_first = own.loc[~none, list(SUMMED)].sort_values("mean_s", kind="stable").rename(columns=SUMMED)
        table = best_first.to_string(index=False, float_format="{:.4g}".format)
        yield from ("", f"{kind}, to {tolerance:g}", *table.splitlines())
        if none.any():
            yield f"all {own['problems'].max()} refused by {'; '.join(own.loc[none, 'solver'])}"


def _ranks_compared(ranks: pd.DataFrame) -> int:
    """Print the correlations of ranks; FAILED where one is below the bar."""
    import numpy as np

    from studies.arena.solver_run import REPEATED

    none, broken = ranks["spearman"].isna(), ranks["spearman"] < REPEATED
    verdicts = np.select([none, broken], ["no ranks", "BROKEN"], "repeats")
    print(f"\nranks of two runs, Spearman's at least {REPEATED:g}")
    columns = ["tolerance", "kind", "problems", "solvers", "spearman", "kendall"]
    shown = ranks[columns].assign(tolerance=ranks["tolerance"].map("{:g}".format), bar=verdicts)
    print(shown.to_string(index=False, float_format="{:.3f}".format))
    return FAILED if broken.any() else OK


def add_leaderboard(parser: argparse.ArgumentParser) -> None:
    """The folder and where the page goes."""
    parser.add_argument("results", type=Path, metavar="RESULTS", help="directory written by bench solvers --results")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="directory of leaderboard.md and leaderboard.html"
    )


def run_leaderboard(options: argparse.Namespace) -> int:
    """Read all, rank, and write the page whole or not at all."""
    from reports.arena_pages import leaderboard
    from reports.files import write_texts
    from studies.arena.collected.dataset import identity
    from studies.arena.ranking import board, read_all
    from studies.arena.results import harness

    check_directory(options.out)
    ranks = board(read_all(options.results))
    counts = ranks.stale, ranks.secrets, (identity(), harness())
    written = write_texts(options.out, leaderboard(ranks.tolerance, ranks.ranked, ranks.runs, ranks.machines, *counts))
    for row in ranks.ranked:
        print(f"{row['rank']}. {row['entry']}: {row['ok']} of {row['asked']} ok, {row['anomalous']} anomalous")
    counted = f"{len(ranks.ranked)} entries, {len(ranks.runs)} results, {ranks.stale} stale"
    print(f"{counted}: {', '.join(map(str, written))}")
    return OK
