"""The tables to be taken away: every cell, every answer, and what each of their columns is.

Rounded: seconds to 4 digits, all else to 10. Cells are numbered in the order of the table, and answers name theirs.
"""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from studies.analysis.cells.rows import answers, reference_rows

DIGITS, OF_SECONDS = 10, 4
CLOCK = "s"  # unit of what is rounded as seconds

ASKED: Mapping[str, tuple[str, str]] = {  # unit and description of what was asked and what became of it
    "cell": ("", "number of the cell, from 0"),
    "label": ("", "its name in the campaign"),
    "id": ("", "name of its record in the store; cells that ask for the same share one, one refused at once has none"),
    "scene": ("", "the problem"),
    "measure": ("", "strain measure"),
    "contact": ("", "contact algorithm"),
    "newton": ("", "form of the Newton iteration"),
    "mesh": ("", "elements along the two directions"),
    "model": ("", "how much of the body is modelled, where a scene has several: full, or a part by symmetry"),
    "element": ("", "name of the options of the element"),
    "section": ("", "law of the section, where a scene has several"),
    "load": ("", "dead or follower, where a scene has both"),
    "epsilon": ("as the scene says", "stiffness of the foundation against penetration; inf: none, contact is exact"),
    "tolerance": ("", "of the relative residual, at which an iteration stops"),
    "outcome": ("", "what became of it: a class, or missing"),
    "reason": ("", "why it ended so"),
    "path_end": ("", "kind of what the equilibrium path itself ends at before the load"),
    "path_end_at": ("as the load", "where the path ends"),
    "path_end_by": ("", "what has found the end of the path"),
    "canary": ("", "quiet: seconds are of the timing lane; moved: it was timed in vain; empty: it was not timed"),
    "machine": ("", "that solved the cell: processor, cores, system, BLAS and its threads; seconds are of one machine"),
    "merged": ("", "of a cell from another store how far it was verified: verified, solved again, unverified failure"),
    "seconds_there": (CLOCK, "processor time that a merged cell claims, of its own machine; it counts nowhere"),
    "command": ("", "solves the cell again"),
}
COUNTED: Mapping[str, tuple[str, str]] = {
    "assemblies": ("", "assemblies of residual and tangent"),
    "dofs": ("", "unknowns"),
    "factorisations": ("", "factorisations of a matrix"),
    "newton_iterations": ("", "linearised problems"),
    "operations": ("operations", "floating-point operations of all kinds"),
    "set_changes": ("", "changes of the contact set"),
    "substeps": ("", "steps of the load, with those that were cut"),
    "superlu_instead": ("", "factorisations by SuperLU where the multifrontal one had no pivot"),
}
WORK: Mapping[str, tuple[str, str]] = {  # by kind
    "assembly": ("operations", "of the elements"),
    "factorisations": ("operations", "of factorisations"),
    "triangular_solutions": ("operations", "of solutions with a factorised matrix"),
    "condensed_columns": ("operations", "of columns of the matrix condensed to the contact candidates"),
    "dense_pivots": ("operations", "of pivots and dense systems"),
    "quadratic_programmes": ("operations", "inside solvers of quadratic programmes"),
}
SPENT: Mapping[str, tuple[str, str]] = {
    "seconds": (CLOCK, "processor time: the median of the timing lane, or of the solve itself"),
    "seconds_low": (CLOCK, "lower end of the interval of the median"),
    "seconds_high": (CLOCK, "upper end of the interval of the median"),
    "total": (CLOCK, "on the clock, of the solve itself"),
    "cpu": (CLOCK, "of the processor, of the solve itself"),
    "build": (CLOCK, "on the clock, for the model"),
    "assembly": (CLOCK, "on the clock, for assembly"),
    "factorisation": (CLOCK, "on the clock, for factorisations"),
    "solve": (CLOCK, "on the clock, for triangular solutions"),
    "contact": (CLOCK, "on the clock, for the contact algorithm"),
}
JUDGED: Mapping[str, tuple[str, str]] = {
    "equilibrium": ("", "relative residual of equilibrium, recomputed by the judge at the last load"),
    "penetration": ("as lengths of the scene", "largest penetration at the last load"),
    "tension": ("as stresses of the scene", "largest tension in contact at the last load"),
    "complementarity": ("as stress times length", "largest product of gap and pressure at the last load"),
}
GROUPS: Mapping[str, tuple[str, Mapping[str, tuple[str, str]]]] = {  # by the prefix of collected columns
    "c.": ("", COUNTED),
    "w.": ("operations_", WORK),
    "t.": ("time_", SPENT),
    "k.": ("residual_", JUDGED),
}
ANSWERS: Mapping[str, tuple[str, str]] = {
    "cell": ("", "number of the cell in cells.csv"),
    "quantity": ("", "its name, which ends in its unit where it has one"),
    "value": ("that of the quantity", "at the last load that was reached, or of the whole path"),
    "reference": ("that of the quantity", "the least uncertain reference that holds for this cell, if any"),
    "uncertainty": ("", "relative, of the reference"),
    "kind": ("", "of the reference: exact, computed, read or printed"),
    "error": ("", "value over reference, minus 1"),
}
OF_ANSWERS = [("answers", name, *told) for name, told in ANSWERS.items()]


def published(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables data_cells, data_answers and data_columns of a collected table."""
    numbered = table.assign(cell=range(len(table)))
    kept = {name: name for name in ASKED}
    kept |= {each: _renamed(each) for each in map(str, numbered) if each[:2] in GROUPS}
    cells = numbered[list(kept)].rename(columns=kept)
    values = _answers(table, numbered)
    columns = pd.DataFrame(
        [("cells", name, *_described(name)) for name in kept.values()] + OF_ANSWERS,
        columns=["table", "column", "unit", "description"],
    )
    return {"data_cells": _rounded(cells, columns), "data_answers": _rounded(values, columns), "data_columns": columns}


def _answers(table: pd.DataFrame, numbered: pd.DataFrame) -> pd.DataFrame:
    own = answers(table)[["label", "quantity", "value"]]
    known = reference_rows(table).rename(columns={"value": "reference"})
    found = own.merge(known, how="left", on=["label", "quantity"]).merge(numbered[["label", "cell"]], on="label")
    found["error"] = found["value"] / found["reference"] - 1
    return found.sort_values("cell", kind="stable")[list(ANSWERS)]


def _renamed(name: str) -> str:
    """A collected column by the name that it is published under: seconds and counters have no prefix."""
    kind, own = name[:2], name[2:]
    prefix, _ = GROUPS[kind]
    return own if own.startswith("seconds") else prefix + own


def _described(name: str) -> tuple[str, str]:
    """Unit and description of a column of the cells; a counter that a part from outside keeps has its name alone."""
    if name in ASKED or name in SPENT:
        return ASKED.get(name) or SPENT[name]
    for prefix, described in GROUPS.values():
        own = name.removeprefix(prefix)
        if prefix and name.startswith(prefix):
            return described.get(own, ("", own.replace("_", " ")))
    return COUNTED.get(name, ("", name.replace("_", " ")))


def _rounded(table: pd.DataFrame, columns: pd.DataFrame) -> pd.DataFrame:
    units = columns.set_index("column")["unit"].to_dict()
    return table.assign(
        **{
            str(name): _significant(table[name], OF_SECONDS if units[name] == CLOCK else DIGITS)
            for name in table.select_dtypes("float")
        }
    )


def _significant(values: pd.Series, digits: int) -> pd.Series:
    return values.map(lambda value: float(f"{value:.{digits}g}"))
