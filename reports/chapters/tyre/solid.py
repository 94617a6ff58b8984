"""Section of the tyre page: the isotropic tyre as a shell and as a solid, split into mesh parts and a model part."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pandas as pd

from reports.chapters.tyre.cells import ISOTROPIC_FINE
from reports.markdown import Part, commands, filled
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("tyre")
PENALTY = 20.0  # MPa/mm, NGSolve's


def solid_part(store: Store) -> Part:
    """The whole section."""
    data = store.table("solid_shell")
    forces, growth = data[data["quantity"] == "force_N"], data[data["quantity"].str.startswith("inflated")]
    order = data["body"].map({"solid": 0, "shell": 2}).fillna(1).argsort(kind="stable")  # the soft plane between them
    cells = {
        "tyre": store.find(scene="tyre-solid", mesh="56x72", epsilon=math.inf).settings,
        "shell": store.find(**ISOTROPIC_FINE).settings,
        "soft": store.find(scene="tyre-solid", epsilon=PENALTY).result,
    }
    told = {
        "rules": store.rules(),
        "finest": forces["mesh"].iloc[-1],
        "changes": ", ".join(filled("{value:+.2%} at {at} mm", data[data["quantity"] == "penalty"])),
        "parts": " and ".join(filled("{model_part:+.2%} ({at})", growth.drop_duplicates("at"))),
        "cancellation": float(growth["cancellation"].iloc[0]),
        "commands": commands(data["command"].iloc[order]),
    }
    return TEXT("solid", **cells, **told, forces=_both(forces), growth=_both(growth))


def _both(data: pd.DataFrame) -> Iterator[dict[Any, Any]]:
    """The row of the solid with that of the shell in it."""
    for _, rows in data.groupby("at", sort=False):
        solid, shell = rows.drop_duplicates("body").to_dict("records")
        yield {**solid, "shell": shell}
