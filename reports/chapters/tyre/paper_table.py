"""The printed pressure table of the paper beside a computed contact table, under a stated reading of its labels.

Maps here have the printed table's shape: rows by row label, columns by psi, increasing; MPa; NaN out of contact. A
reading says which phi a row label means. Nothing is fitted here; the pages choose what to show.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from reports.maps import ANGLE_DECIMALS, pressure_map

FILE = "paper_contact_pressure_delta20.csv"
PRINTED_FACTOR = 10.0  # the table gives -10 q
PRINTED_DIGIT = 0.001  # MPa, one unit of its last digit
DEPTH = 2  # nodes between the core and the rim of the printed patch
HALF, LITERAL = 0.5, 1.0  # phi in degrees per unit of row label


def printed_map(table: pd.DataFrame) -> pd.DataFrame:
    """The printed table in MPa."""
    by_label = table.set_index("row_label").sort_index() / PRINTED_FACTOR
    by_label.columns = pd.Index([float(column) for column in by_label.columns], name="psi")
    by_label.index = pd.Index([float(label) for label in by_label.index], name="row_label")
    return by_label.sort_index(axis=1)


def on_printed_nodes(contact: pd.DataFrame, printed: pd.DataFrame, phi_per_label: float) -> pd.DataFrame:
    """A computed contact table of one travel at the printed places; NaN off the patch and off the mesh."""
    computed = pressure_map(contact).T
    phi = [round(float(label) * phi_per_label, ANGLE_DECIMALS) + 0.0 for label in printed.index]
    places = computed.reindex(index=pd.Index(phi), columns=printed.columns)
    places.index = printed.index
    return places


def core(patch: np.ndarray, depth: int = DEPTH) -> np.ndarray:
    """The nodes of a patch whose ``depth`` neighbours along both directions, both ways, belong to it, too.

    Outside the table nothing belongs to the patch.
    """
    padded = np.pad(patch, depth)
    rows, columns = patch.shape
    kept = patch.copy()
    for k in range(2 * depth + 1):
        kept &= padded[k : k + rows, depth : depth + columns]
        kept &= padded[depth : depth + rows, k : k + columns]
    return kept


@dataclass(frozen=True)
class Comparison:
    """Computed against printed: centre pressures [MPa], rms of (computed - printed)/printed over the core, node counts.

    ``core_rms`` is None when no core node touches in ours. ``outside``: printed entries off the computed patch.
    """

    centre: float
    printed_centre: float
    core_rms: float | None
    core_nodes: int
    nodes: int
    printed_nodes: int
    both: int

    @property
    def symmetric_difference(self) -> int:
        """Nodes of the printed places in exactly one of the patches."""
        return self.nodes + self.printed_nodes - 2 * self.both

    @property
    def outside(self) -> int:
        """Printed entries that lie off the computed patch."""
        return self.printed_nodes - self.both


def compare(computed: pd.DataFrame, printed: pd.DataFrame) -> Comparison:
    """Compare two maps of the same places."""
    ours, theirs = computed.to_numpy(dtype=float), printed.to_numpy(dtype=float)
    here, there = ~np.isnan(ours), ~np.isnan(theirs)
    inside = core(there) & here
    relative = ours[inside] / theirs[inside] - 1.0
    middle = (int(np.argmin(np.abs(printed.index))), int(np.argmin(np.abs(printed.columns))))
    return Comparison(
        centre=float(np.nan_to_num(ours[middle])),
        printed_centre=float(theirs[middle]),
        core_rms=float(np.sqrt(np.mean(relative**2))) if inside.any() else None,
        core_nodes=int(inside.sum()),
        nodes=int(here.sum()),
        printed_nodes=int(there.sum()),
        both=int((here & there).sum()),
    )


def force(pressures: pd.DataFrame, phi_per_label: float, settings: Mapping[str, Any]) -> float:
    """Sum of pressures times mid-surface nodal areas [N].

    Torus, inner face as reference surface: A1 = R1, A2 = Rc + R1 cos psi, zeta_i = 1 + k_i h/2; area of a node
    dpsi dphi A1 A2 zeta1 zeta2, with R1 and Rc = R0 - R1 [mm] and the thickness h from the settings of the tyre.
    """
    psi = np.deg2rad(np.asarray(pressures.columns, dtype=float))
    labels = np.asarray(pressures.index, dtype=float)
    dpsi, dphi = psi[1] - psi[0], np.deg2rad((labels[1] - labels[0]) * phi_per_label)
    R1, Rc = settings["R1_mm"], settings["R0_mm"] - settings["R1_mm"]
    middle = 0.5 * settings["plies"] * settings["ply_thickness_mm"]
    A2 = Rc + R1 * np.cos(psi)
    zeta1, zeta2 = 1 + middle / R1, 1 + middle * np.cos(psi) / A2
    areas = dpsi * dphi * R1 * A2 * zeta1 * zeta2
    return float(np.sum(np.nan_to_num(pressures.to_numpy(dtype=float)) * areas))


IMAGES = {
    "central: p(psi, phi) - p(-psi, -phi)": (slice(None, None, -1), slice(None, None, -1)),
    "mirror: p(psi, phi) - p(-psi, phi)": (slice(None), slice(None, None, -1)),
    "mirror: p(psi, phi) - p(psi, -phi)": (slice(None, None, -1), slice(None)),
}


def asymmetry(pressures: pd.DataFrame, image: str) -> tuple[float, float]:
    """Largest difference from an image [MPa]: with no contact as zero pressure, and over pairs that both touch."""
    p = pressures.to_numpy(dtype=float)
    difference = np.abs(p - p[IMAGES[image]])
    filled = np.nan_to_num(p)
    return float(np.max(np.abs(filled - filled[IMAGES[image]]))), float(np.nanmax(difference))


def handedness(computed: pd.DataFrame, printed: pd.DataFrame) -> float:
    """Correlation of the mirror-odd parts of two maps where both and their mirror images touch.

    Positive when the pressures of both turn the same way, near -1 when one is the mirror image of the other.
    """
    odd = [p - p[:, ::-1] for p in (computed.to_numpy(dtype=float), printed.to_numpy(dtype=float))]
    both = ~np.isnan(odd[0]) & ~np.isnan(odd[1])
    return float(np.corrcoef(odd[0][both], odd[1][both])[0, 1])
