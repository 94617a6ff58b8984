"""What is said of the price of accuracy."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import FINDING, OPENING, Statement

TOLD = (0.05, 0.01, 0.002)  # errors of which a sentence tells


def prices(price_of_accuracy: pd.DataFrame) -> Iterator[Statement]:
    """A sentence a scene: seconds and unknowns for each error, or how near one gets."""
    for scene, own in price_of_accuracy.groupby("scene", sort=False):
        values: dict[str, float | str] = {"scene": str(scene), "quantity": f"`{own['quantity'].iloc[0]}`"}
        said = []
        for n, row in enumerate(own[own["tolerance"].isin(TOLD)].to_dict("records")):
            values |= {f"within{n}": float(row["tolerance"]), f"seconds{n}": float(row["seconds"])}
            values |= {f"unknowns{n}": float(row["unknowns"]), f"bound{n}": float(row["bound"])}
            if row["reached"]:
                said.append(f"{{within{n}:.1%}} costs {{seconds{n}:.2g}} s and {{unknowns{n}:.0f}} unknowns")
            else:
                said.append(f"{{within{n}:.1%}} is not reached (nearest {{bound{n}:.2%}})")
        if not said:
            continue
        text = f"{{scene}}, {{quantity}}, by the fastest single cell: {'; '.join(said)}."
        scope = f"against {own['against'].iloc[0]}; the cheapest of {int(own['cells'].max())} solved configurations"
        yield Statement(
            f"price-{scene}", "tradeoff", text, values, int(own["cells"].max()), scope, OPENING, machine=True
        )


def one_per_cent(price_of_accuracy: pd.DataFrame) -> Iterator[Statement]:
    """What 1 % costs over 5 %."""
    wide = price_of_accuracy[price_of_accuracy["reached"].astype(bool)]
    wide = wide.pivot_table(index="scene", columns="tolerance", values="seconds", sort=False)
    if not {0.05, 0.01} <= set(wide.columns):
        return
    ratio = (wide[0.01] / wide[0.05]).dropna()
    if ratio.empty:
        return
    values = {"low": ratio.min(), "high": ratio.max(), "scenes": float(len(ratio))}
    text = "1 % costs {low:.1f} to {high:.1f} times the seconds of 5 % on {scenes:.0f} scenes that reach both."
    scope = "cheapest configurations of each"
    yield Statement("one-per-cent", "tradeoff", text, values, len(ratio), scope, FINDING, machine=True)


MAKERS = (prices, one_per_cent)
