"""Uncertainties held against what is known: the crushed ring beside its test, stated errors beside true ones.

What the difference of the computed ring to the measured one is made of, and whether the test contradicts it.

Parts, with the sign that they have in S - D (S computed on the finest mesh, D measured), L a limit of meshes::

    mesh       S - L                          what the mesh of the body leaves
    shell      L - L(solid of its law)        what the shell's kinematics and measure leave
    law        L(solid of its law) - L(Hencky's solid)
    friction   -(r - 1) L(Hencky)             missing in the computation; r at mu = 0.4: a bound
    reading    L(Hencky) less its own chord   what a curve has more than the straight line that was read of it
    remainder  all the rest

In the sense of ASME V&V 20 the statement is E = S - D beside u_val = sqrt(u_num^2 + u_input^2 + u_D^2), all standard
uncertainties: |E| <= u_val says that the test cannot tell the model's error from none. u_num is half of what
:func:`studies.solving.refinement.richardson.limit_of` says; limits +-a are a/sqrt(3).

Other programs beside ours, what they take at equal error and find for our decks on their finest meshes: from the tables
of ``footprint bench peers`` and ``footprint bench programs``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from studies.experiments.solid_laws import INPUTS, MESHES, STATES
from studies.scenes.contact.crushed_ring import DATA, FILE, READING
from studies.scenes.data import read_reference
from studies.solving.refinement.richardson import Limit, holds_from, limit_of

PARTS = ("mesh", "shell", "law", "friction", "reading", "remainder")
OWN_LAW, SOFTER = "solid svk", "solid hencky"  # the law of every shell, and the one that the test is compared with
WITHIN = np.sqrt(3.0)  # limits over the standard deviation of all values between them
COVERED = 2.0  # of a standard uncertainty: what limit_of says covers nearly all cases


def error_budget(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each body and travel: measured_N, force_N, difference_N, PARTS, u_val [N], limit_N of all meshes.

    within: |difference| <= u_val.  wrong_reason: a shell of another measure is nearer to the measured force than the
    exact one with the same data, although its own part is larger, by taking a share of the law's part back.
    """
    meshes = study[study["study"] == MESHES].groupby(["body", "delta_mm"], sort=False)
    limits = {
        (rows["body"].iloc[0], float(rows["delta_mm"].iloc[0])): limit_of(
            rows["size"].tolist(), rows["force_N"].tolist()
        )
        for _, rows in meshes
    }
    measured = read_reference(FILE).set_index("delta_mm")
    finest = meshes.last().reset_index()
    inputs = input_effects(study).groupby("delta_mm")["relative"].apply(lambda each: float(np.hypot.reduce(each)))
    rows = [
        _parts(row, limits, measured.loc[row["delta_mm"]], inputs[row["delta_mm"]], measured.index[-1])
        for row in finest.to_dict("records")
    ]
    return pd.DataFrame([{**row, "wrong_reason": _by_cancelling(row, rows)} for row in rows])


def input_effects(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each input and travel: its value, and relative, the standard uncertainty of the force."""
    rows = []
    for (key, delta), pair in study[study["study"] == INPUTS].groupby(["input", "delta_mm"], sort=False):
        low, high = pair.sort_values("change")["force_N"]
        effect = (high - low) / (high + low)
        rows.append({"input": key, "value": DATA[str(key)], "delta_mm": delta, "relative": abs(effect) / WITHIN})
    return pd.DataFrame(rows)


def axial_states(study: pd.DataFrame) -> pd.DataFrame:
    """A row for each state along the axis and travel: ``off``, the force of Hencky's solid against plane strain."""
    other = study[study["study"] == STATES]
    plane = study[(study["study"] == MESHES) & (study["body"] == SOFTER)].drop_duplicates("delta_mm", keep="first")
    strain = plane.set_index("delta_mm")["force_N"]
    off = other["force_N"].to_numpy() / strain[other["delta_mm"]].to_numpy() - 1
    return pd.DataFrame({"state": other["input"], "delta_mm": other["delta_mm"], "off": off})


def _parts(
    row: Mapping[Any, Any], limits: Mapping[tuple[str, float], Limit], read: pd.Series, relative: float, end: float
) -> dict[str, Any]:
    """One body at one travel."""
    delta, S, D = row["delta_mm"], row["force_N"], float(read["measured_N"])
    own, hencky = limits[row["body"], delta], limits[SOFTER, delta].value
    of_law = limits[OWN_LAW, delta].value if row["kind"] == "shell" else own.value
    friction = -(read["aster_friction_N"] / read["aster_N"] - 1) * hencky
    bend = hencky - delta / end * limits[SOFTER, end].value
    known = {"mesh": S - own.value, "shell": own.value - of_law, "law": of_law - hencky}
    known |= {"friction": friction, "reading": bend}
    u_num, u_input = own.uncertainty / COVERED, np.hypot(relative * S, friction / WITHIN)
    u_D = np.hypot(READING, bend) / WITHIN
    u_val = float(np.sqrt(u_num**2 + u_input**2 + u_D**2))
    return {
        **{name: row[name] for name in ("body", "kind", "of", "delta_mm", "command", "least_stretch")},
        "largest_stretch": row["largest_stretch"],
        "limit_N": own.value,
        "measured_N": D,
        "force_N": S,
        "difference_N": S - D,
        **known,
        "remainder": hencky - D - friction - bend,
        "u_val": u_val,
        "within": abs(S - D) <= u_val,
    }


def _by_cancelling(row: Mapping[str, Any], rows: list[dict[str, Any]]) -> bool:
    """Is a shell of another measure closer than the exact one although its own part is larger?"""
    if row["kind"] != "shell" or row["of"] == "exact":
        return False
    name = row["body"].replace(row["of"], "exact")
    exact = next(each for each in rows if (each["body"], each["delta_mm"]) == (name, row["delta_mm"]))
    closer = abs(row["difference_N"]) < abs(exact["difference_N"])
    return bool(closer and abs(row["shell"]) > abs(exact["shell"]) and row["shell"] * row["law"] < 0)


ROUNDING = 1e-9  # relative: a smaller uncertainty is not a statement about a grid
TIMES = 4.0  # the CPU time of the cheapest grid as good, above which a statement counts as expensive
STATEMENT = ["scene", "settings", "quantity", "unknowns"]  # larger errors may end at one and the same grid
STATED_COLUMNS = (
    *("asked", "asked_for", "reached", "statements", "priced", "cost", "expensive"),
    *("scenes", "decided", "inside", "wide", "limit_decided", "limit_inside", "limit_wide"),
)


def error_statements(coverage: pd.DataFrame) -> pd.DataFrame:
    """STATED_COLUMNS, a row an error asked for; in a last one for all asked is NaN and equal statements count once.

    coverage: of error_coverage.  statements: those that were reached, but for ROUNDING.  cost:
    median of the CPU time over that of the cheapest grid known to be as good, of those priced; expensive: how many take
    more than TIMES.  decided, on so many scenes: those whose true error of the last grid's value is known well enough;
    inside: where it is as stated; wide: median of the width of the stated interval over that error.  limit_*: the same
    of the extrapolated limit and its uncertainty.
    """
    rows = [_row(own, asked) for asked, own in coverage.groupby("asked", sort=False)]
    return pd.DataFrame([*rows, _row(coverage.drop_duplicates(STATEMENT), math.nan)], columns=list(STATED_COLUMNS))


def statements(coverage: pd.DataFrame) -> pd.DataFrame:
    """The rows of a coverage that state something."""
    return coverage[coverage["reached"].eq(True) & (coverage["uncertainty"] > ROUNDING)]


def _row(coverage: pd.DataFrame, asked: object) -> dict[str, object]:
    made = statements(coverage)
    of_value, of_limit = (made[made[name].eq(True)] for name in ("value_decided", "decided"))
    return {
        "asked": asked,
        "asked_for": len(coverage),
        "reached": int(coverage["reached"].sum()),
        "statements": len(made),
        "priced": int(made["cost"].notna().sum()),
        "cost": made["cost"].median(),
        "expensive": int((made["cost"] > TIMES).sum()),
        "scenes": of_value["scene"].nunique(),
        "decided": len(of_value),
        "inside": int(of_value["value_inside"].sum()),
        "wide": ((of_value["high"] - of_value["low"]) / of_value["value_error"]).median(),
        "limit_decided": len(of_limit),
        "limit_inside": int(of_limit["inside"].sum()),
        "limit_wide": (of_limit["uncertainty"] / of_limit["off"]).median(),
    }


OURS = "footprint"
GIVEN = ("within", "bar", "value")
NEEDED = ("mesh", "unknowns", "error", "seconds", "units")


def peer_factors(table: pd.DataFrame) -> pd.DataFrame:
    """A row a line: problem, program, family, within, bar, and the mesh of it that is sufficient, with its cost.

    Sufficient is the coarsest mesh from which on the error of every finer one is at most ``within``, for a coarse one
    may be by luck; none leaves mesh empty and numbers nan.  factor: its seconds over those of our cheapest line.
    bare: the same if ours took nothing but its factorisations.  apart: the value of its finest mesh over that of this
    line of ours, less one.
    """
    rows = [
        {**dict(zip(("problem", "program", "family"), key, strict=True)), **_line(own)}
        for key, own in table.groupby(["problem", "program", "family"], sort=False)
    ]
    peers = pd.DataFrame(rows)
    ours = peers[peers["program"] == OURS].sort_values("seconds", kind="stable").drop_duplicates("problem")
    cheapest = ours.dropna(subset="seconds").set_index("problem").reindex(peers["problem"]).set_axis(peers.index)
    factors = {"factor": peers["seconds"] / cheapest["seconds"], "bare": peers["seconds"] / cheapest["factorisation"]}
    factored = peers.assign(**factors, apart=peers["value"] / cheapest["value"] - 1)
    return factored.drop(columns=["value", "factorisation"])


def _line(own: pd.DataFrame) -> dict[str, object]:
    """What one line needs, and where it ends."""
    meshes = own.sort_values("unknowns")
    enough = meshes.iloc[holds_from(meshes["error"].abs() <= meshes["within"]) :]
    nothing = pd.Series({"mesh": "", **dict.fromkeys((*NEEDED[1:], "factorisation"), math.nan)})
    first, last = enough.iloc[0] if len(enough) else nothing, meshes.iloc[-1]
    return {name: last[name] for name in GIVEN} | {name: first[name] for name in (*NEEDED, "factorisation")}


def agreement(programs: pd.DataFrame) -> pd.DataFrame:
    """The rows of the finest mesh of each case and program."""
    most = programs.groupby(["case", "program"])["bricks"].transform("max")
    return programs[programs["bricks"] == most].reset_index(drop=True)
