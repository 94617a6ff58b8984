"""The tables of the catalogue, read once for all of its sheets, and what these share."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from textwrap import dedent
from typing import Any

import numpy as np
import pandas as pd

from reports.figures.relief import Body, View
from reports.formats import share
from reports.markdown import Part, Template
from reports.store import Store

TABLES = ("parts", "settings", "facts", "plies", "terms", "laws", "values", "answers", "marks", "points", "quads")
NEEDS = tuple(f"sheet_{name}" for name in TABLES)
FRAME = "sheet tyre at "  # how the labels of the filmstrip begin
KINDS = {"scene": "Scene", "measure": "Strain measure", "algorithm": "Contact algorithm"}


@dataclass(frozen=True, eq=False)
class Catalogue:
    """The tables of the sheets by their short names; bodies by the labels of their cells."""

    store: Store
    tables: dict[str, pd.DataFrame]
    bodies: dict[str, Body] = field(repr=False)

    @classmethod
    @lru_cache(maxsize=8)
    def of(cls, store: Store) -> Catalogue:
        """Of a store, read once."""
        tables = {name: store.table(f"sheet_{name}") for name in TABLES}
        quads = dict(iter(tables["quads"].groupby("label", sort=False)))
        seen = tables["parts"][tables["parts"]["kind"] == "scene"]
        views = {
            each["part"]: View.of(each["up"], each["azimuth_deg"], each["elevation_deg"])
            for each in seen.to_dict("records")
        }
        bodies = {}
        for label, own in tables["points"].groupby("label", sort=False):
            columns = (["x", "y", "z"], ["ux", "uy", "uz"], "pressure")
            rest, u, pressure = (own[each].to_numpy(float) for each in columns)
            corners = quads[label][["a", "b", "c", "d"]].to_numpy(int)
            bodies[str(label)] = Body(rest, u, pressure, corners, views.get(own["scene"].iloc[0], View.of()))
        return cls(store, tables, bodies)

    def own(self, table: str, **where: str) -> pd.DataFrame:
        """The rows of a table with these words."""
        every = self.tables[table]
        keep = np.logical_and.reduce([every[key] == value for key, value in where.items()])
        return every[keep]

    def sheets(self, *kinds: str) -> Iterator[Any]:
        """The parts of some kinds in the order of their catalogues, each with the name and the title of its page."""
        parts = self.tables["parts"][["kind", "part", "meaning", "about", "source", "module"]].fillna("").astype(str)
        named = parts.assign(
            name="sheets/" + parts["kind"] + "-" + parts["part"], title=parts["kind"].map(KINDS) + ": " + parts["part"]
        )
        return named[named["kind"].isin(kinds)].itertuples(index=False, name="Sheet")

    def body(self, scene: str) -> Body | None:
        """That of the sheet of a scene, None where its cell has no fields."""
        return self.bodies.get(f"sheet {scene}")

    @property
    def frames(self) -> list[tuple[str, Body]]:
        """The tyre at growing travel."""
        return [(label.removeprefix(FRAME), body) for label, body in self.bodies.items() if label.startswith(FRAME)]

    def settings(self, kind: str, part: str) -> Part:
        """Settings with meaning, unit, range and default."""
        own = self.own("settings", kind=kind, part=part).fillna("")
        return TEXT("settings", rows=own) if len(own) else Part()


def known(uncertainty: float) -> str:
    """In per cent, with two digits where that is small."""
    return f"{100 * uncertainty:.2g} %" if 0 < uncertainty < 1e-4 else share(uncertainty, 2)


def about(text: str) -> str:
    """Paragraphs of a part's own words; what is indented is an equation, and what looks like markup is none."""
    pieces = (_fenced(each) if each.startswith("    ") else _plain(each) for each in text.strip("\n").split("\n\n"))
    return "\n\n".join(["## About", *pieces]) if text.strip() else ""


def _fenced(text: str) -> str:
    return "\n".join(["```", dedent(text), "```"])


def _plain(text: str) -> str:
    escaped = text.replace("<", "&lt;").replace("|", "\\|").replace("*", "\\*").replace("_", "\\_")
    return escaped.removesuffix(":") if escaped.endswith("::") else escaped


TEXT = Template("sheets", known=known)
