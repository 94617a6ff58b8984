"""Contact tables as maps over the meridian angle psi (rows) and the angle phi around the axis (columns), in degrees,
and the same places in millimetres of the outer face.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

ANGLE_DECIMALS = 6  # nodes are told apart by angles rounded to this
SHOWN_PSI = 60.0  # degrees to either side of the equator, beyond which nothing touches


@dataclass(frozen=True, eq=False)
class Developed:
    """The inflated outer face rolled out: psi [deg] (n,) with arc length [mm] (n,) from the equator, and the radius of
    the equator [mm].
    """

    psi: np.ndarray
    arc: np.ndarray
    radius: float

    @classmethod
    def of(cls, profile: pd.DataFrame) -> Developed:
        """From the table of profiles."""
        inflated = profile[profile["state"] == "inflated"].sort_values("psi_deg")
        psi, radial, axial = (
            inflated[name].to_numpy(float) for name in ("psi_deg", "outer_radial_mm", "outer_axial_mm")
        )
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(radial), np.diff(axial)))])
        return cls(psi, arc - np.interp(0.0, psi, arc), float(np.interp(0.0, psi, radial)))

    def along(self, psi: np.ndarray) -> np.ndarray:
        """Arc length along the meridian [mm]."""
        return np.interp(psi, self.psi, self.arc)

    def around(self, phi: np.ndarray) -> np.ndarray:
        """Arc length along the equator [mm]."""
        return self.radius * np.deg2rad(phi)

    @property
    def per_degree(self) -> tuple[float, float]:
        """Lengths [mm] of a degree of psi and of phi at the equator."""
        crown = int(np.argmin(np.abs(self.psi)))
        near = slice(crown - 1, crown + 2)
        return float(np.ptp(self.arc[near]) / np.ptp(self.psi[near])), float(np.deg2rad(self.radius))


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
