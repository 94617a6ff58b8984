"""What is said of contact algorithms over all cells: what each solves, refuses and costs."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import LIMIT, Statement

SCOPE = "problems put to two algorithms at least; those whose path ends before the load are left out"


def ratios(contact_summary: pd.DataFrame) -> Iterator[Statement]:
    """Seconds over those of the default, with intervals."""
    own = contact_summary[contact_summary["algorithm"] != contact_summary["default"]].dropna(subset=["seconds_ratio"])
    if own.empty:
        return
    values: dict[str, float | str] = {"default": f"`{own['default'].iloc[0]}`"}
    said = []
    for n, row in enumerate(own.sort_values("seconds_ratio", kind="stable").to_dict("records")):
        values |= {f"name{n}": f"`{row['algorithm']}`", f"both{n}": float(row["both"])}
        values |= {f"share{n}": float(row["solved_share"])}
        values |= {f"{end}{n}": float(row[f"seconds_{end}"]) for end in ("ratio", "low", "high")}
        said.append(
            f"{{name{n}}} {{ratio{n}:.2f}} [{{low{n}:.2f}}, {{high{n}:.2f}}] "
            f"({{both{n}:.0f}} solved by both; solves {{share{n}:.0%}})"
        )
    text = f"Processor time over that of {{default}}, in the median over problems that both solve: {', '.join(said)}."
    scope = f"{SCOPE}; most are small; 95 % intervals of drawing scenes"
    yield Statement("algorithm-cost", "algorithms", text, values, int(own["both"].max()), scope, machine=True)


def failures(outcomes: pd.DataFrame) -> Iterator[Statement]:
    """Where an algorithm fails that others solve."""
    own = outcomes[(outcomes["axis"] == "contact") & outcomes["scene"].notna()]
    if own.empty:
        return
    lost = own[own["failed"] > 0]
    told = ", ".join(
        f"`{row['name']}` {row['failed']} of {row['planned'] - row['refused'] - row['path_ends']} on {row['scene']}"
        for row in lost.sort_values("failed", ascending=False, kind="stable").head(6).to_dict("records")
    )
    values: dict[str, float | str] = {"failed": float(lost["failed"].sum()), "told": told}
    values |= {"planned": float(own["planned"].sum()), "names": float(own["name"].nunique())}
    text = "Of {planned:.0f} requests put to {names:.0f} contact algorithms {failed:.0f} fail"
    text += ": {told}." if told else ": every algorithm converges on every scene that it takes."
    yield Statement("algorithm-failures", "algorithms", text, values, int(own["planned"].sum()), SCOPE, LIMIT)
    trial = own[own["name"] == "trial-and-error"]
    if trial.empty:
        return
    where = trial[trial["failed"] > 0]
    could = trial["planned"] - trial["refused"] - trial["path_ends"]
    values = {"scenes": ", ".join(where["scene"]), "lost": float(trial["failed"].sum()), "of": float(could.sum())}
    values |= {"count": float(len(trial))}
    ends = (
        "does not converge on {lost:.0f} of {of:.0f} problems, on {scenes}"
        if len(where)
        else "converges on all {of:.0f} problems of all {count:.0f} scenes"
    )
    text = f"`trial-and-error` is the paper's algorithm with a detector of cycles added. It {ends}; problems that no "
    text += "algorithm solves are not counted."
    yield Statement("trial-and-error-ends", "algorithms", text, values, int(could.sum()), SCOPE)


MAKERS = (ratios, failures)
