"""What is said of contact algorithms: what each solves, refuses and costs, and over which sizes."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import LIMIT, OPENING, Statement

RATIO = "seconds_over_default"
SCOPE = "problems put to two algorithms at least; those whose path ends before the load are left out"


def recommended(contact_summary: pd.DataFrame, contact_sizes: pd.DataFrame) -> Iterator[Statement]:
    """Which algorithm, and when not: of those that solve most and refuse nothing, the fastest on the largest grid."""
    largest = contact_sizes[contact_sizes["unknowns"] == contact_sizes["unknowns"].max()]
    own = contact_summary.merge(largest[["algorithm", "unknowns", RATIO]], how="left", on="algorithm")
    own = own.sort_values(["solved_share", "refused"], ascending=[False, True], kind="stable")
    able = own[(own["refused"] == 0) & (own["solved_share"] == own["solved_share"].max())]
    if able.empty:
        return
    best = able.sort_values(RATIO, kind="stable").iloc[0]
    values: dict[str, float | str] = {"best": f"`{best['algorithm']}`", "share": float(best["solved_share"])}
    values |= {"problems": float(best["problems"] - best["path_ends"]), "scenes": float(best["scenes"])}
    values |= {"default": f"`{best['default']}`"}
    text = (
        "Take {best}: it solves {share:.0%} of {problems:.0f} contact problems of {scenes:.0f} scenes and refuses none"
    )
    text += ", and is the fastest of those that do so on the tyre of {unknowns:.0f} unknowns"
    values |= {"unknowns": float(largest["unknowns"].iloc[0])}
    if best["algorithm"] != best["default"]:
        values |= {"ratio": float(best[RATIO])}
        text += ", at {ratio:.2f} times the time of {default}"
    small = able.dropna(subset=["seconds_ratio"]).sort_values("seconds_ratio", kind="stable").head(1)
    if len(small) and small["algorithm"].iloc[0] != best["algorithm"]:
        values |= {"small": f"`{small['algorithm'].iloc[0]}`", "small_ratio": float(small["seconds_ratio"].iloc[0])}
        text += "; on small problems {small} takes {small_ratio:.2f} times the time of {default} in the median"
    partial = own[(own["solved_share"] < own["solved_share"].max()) | (own["refused"] > 0)]
    for number, row in enumerate(partial.to_dict("records")):
        values |= {f"name{number}": f"`{row['algorithm']}`", f"share{number}": float(row["solved_share"])}
        values |= {f"refused{number}": float(row["refused"])}
    if len(partial):
        told = (f"{{name{n}}} solves {{share{n}:.1%}} and refuses {{refused{n}:.0f}}" for n in range(len(partial)))
        text += "; " + ", ".join(told)
    yield Statement(
        "which-algorithm", "algorithms", f"{text}.", values, int(own["problems"].max()), SCOPE, OPENING, machine=True
    )


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


def sizes(contact_sizes: pd.DataFrame) -> Iterator[Statement]:
    """The same at the largest size."""
    own = contact_sizes.dropna(subset=[RATIO])
    own = own[own["algorithm"] != "semismooth"]
    if own.empty:
        return
    small, large = own["unknowns"].min(), own["unknowns"].max()
    values: dict[str, float | str] = {"small": float(small), "large": float(large)}
    said = []
    for n, (name, rows) in enumerate(own.sort_values("unknowns", kind="stable").groupby("algorithm", sort=False)):
        values |= {f"name{n}": f"`{name}`", f"first{n}": float(rows[RATIO].iloc[0])}
        values |= {f"last{n}": float(rows[RATIO].iloc[-1]), f"at{n}": float(rows["unknowns"].iloc[-1])}
        said.append(f"{{name{n}}} {{first{n}:.2f}} to {{last{n}:.2f}} (at {{at{n}:.0f}})")
    text = (
        "On the tyre, from {small:.0f} to {large:.0f} unknowns, seconds over those of `semismooth` go from the first "
        f"to the second number: {', '.join(said)}."
    )
    scope = "one path to 20 mm by each algorithm; what is not there was not solved at that size"
    yield Statement("algorithm-sizes", "algorithms", text, values, len(own), scope, machine=True)


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
    text = "Of {planned:.0f} contact problems put to {names:.0f} algorithms {failed:.0f} fail"
    text += ": {told}." if told else ": every algorithm ends on every scene that it takes, and where its path goes on."
    yield Statement("algorithm-failures", "outcomes", text, values, int(own["planned"].sum()), SCOPE, LIMIT)
    trial = own[own["name"] == "trial-and-error"]
    if trial.empty:
        return
    where = trial[trial["failed"] > 0]
    could = trial["planned"] - trial["refused"] - trial["path_ends"]
    values = {"scenes": ", ".join(where["scene"]), "lost": float(trial["failed"].sum()), "of": float(could.sum())}
    values |= {"count": float(len(trial))}
    ends = (
        "does not end on {lost:.0f} of {of:.0f} problems, on {scenes}"
        if len(where)
        else "ends on all {of:.0f} problems of all {count:.0f} scenes"
    )
    text = f"`trial-and-error`, the paper's algorithm with a detector of cycles, which the paper does not have, {ends};"
    text += " problems whose path ends before the load are left out."
    yield Statement("trial-and-error-ends", "outcomes", text, values, int(could.sum()), SCOPE)


def measures_fail(outcomes: pd.DataFrame) -> Iterator[Statement]:
    """Which measure does not get there."""
    own = outcomes[(outcomes["axis"] == "measure") & outcomes["scene"].isna()]
    if own.empty:
        return
    left = own["planned"] - own["refused"]
    values: dict[str, float | str] = {"planned": float(left.sum()), "names": float(len(own))}
    values |= {"failed": float(own["failed"].sum()), "ends": float(own["path_ends"].sum())}
    worst = own.iloc[int((own["failed"] + own["path_ends"]).argmax())]
    values |= {"worst": f"`{worst['name']}`", "worst_ends": float(worst["path_ends"] + worst["failed"])}
    values |= {"worst_of": float(worst["planned"] - worst["refused"])}
    text = (
        "Of {planned:.0f} problems put to {names:.0f} strain measures {failed:.0f} fail and {ends:.0f} have a path "
        "that ends before the load; most often with {worst}, {worst_ends:.0f} of {worst_of:.0f}."
    )
    scope = "problems put to two measures at least"
    yield Statement("measure-failures", "outcomes", text, values, int(left.sum()), scope)


MAKERS = (recommended, ratios, sizes, failures, measures_fail)
