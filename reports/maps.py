"""Contact tables as maps over the meridian angle psi (rows) and the angle phi around the axis (columns), in degrees."""

from __future__ import annotations

import numpy as np
import pandas as pd

ANGLE_DECIMALS = 6  # nodes are told apart by angles rounded to this


def at_delta(table: pd.DataFrame, delta: float) -> pd.DataFrame:
    """The rows of one travel of the plane."""
    return table[(table["delta_mm"] - delta).abs() < 1e-9]


def pressure_map(contact: pd.DataFrame) -> pd.DataFrame:
    """Pressure [MPa] of one travel by psi and phi; NaN where the node is not in contact."""
    nodes = pd.DataFrame(
        {
            "psi": contact["psi_deg"].round(ANGLE_DECIMALS) + 0.0,
            "phi": contact["phi_deg"].round(ANGLE_DECIMALS) + 0.0,
            "pressure": contact["pressure_MPa"].where(contact["active"] == 1),
        }
    )
    return nodes.pivot(index="psi", columns="phi", values="pressure").sort_index().sort_index(axis=1)


def along_meridian(contact: pd.DataFrame) -> pd.Series:
    """Pressure [MPa] by psi at phi = 0, zero out of contact."""
    return pressure_map(contact)[0.0].fillna(0.0)


def different_nodes(a: pd.DataFrame, b: pd.DataFrame) -> int | None:
    """How many nodes are in contact in only one of two tables of one travel; None on different meshes."""
    if len(a) != len(b) or not np.allclose(a[["psi_deg", "phi_deg"]], b[["psi_deg", "phi_deg"]], atol=1e-9):
        return None
    return int(np.sum(a["active"].to_numpy() != b["active"].to_numpy()))
