"""The printed pressure table of the paper beside the computed one, under stated readings of its labels.

Maps here have the printed table's shape: rows by row label, columns by psi, increasing; MPa; NaN out of contact. A
reading says which travel is compared and which phi a row label means, or changes one thing of the paper's tyre. Every
reading is held against the same printed nodes by the same measures; nothing is fitted but the travel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from scipy.ndimage import binary_erosion

from formulations.element.strain_operator import area_factor
from formulations.geometry.surfaces import torus
from studies.run.answers import Answer, Answers
from studies.run.lists import READINGS, TYRE
from studies.scenes.data import read_reference
from studies.scenes.tyre.readings import deviation

FILE = "paper_contact_pressure_delta20.csv"
PRINTED_FACTOR = 10.0  # the table gives -10 q
DELTA = 20.0  # mm, the travel that the table states
DEPTH = 2  # nodes between the core and the rim of the printed patch
HALF, LITERAL = 0.5, 1.0  # phi in degrees per unit of row label
ANGLE_DECIMALS = 6  # nodes are one where their angles are, rounded to this
PAPER = TYRE[:1]
COLUMNS = (
    *("delta_mm", "phi_per_label", "centre_MPa", "printed_centre_MPa", "printed_nodes", "outside", "force_N"),
    *("own_sum_N", "printed_sum_N", "handedness"),
)
SYMMETRY_COLUMNS = ("who", "delta_mm", "image", "both_touch_MPa")
READING_COLUMNS = (
    *("reading", "kind", "delta_mm", "stated", "best", "force_N", "printed_sum_N", "centre_MPa", "core_rms"),
    *("in_one_only", "label", "command"),
)
MODEL, DATA = "model", "data"  # what is changed
FIRST = "as stated in the paper"
WORDS = {
    **{"paper": (FIRST, MODEL), "reading linear": ("linear strains", MODEL), "reading 84x80": ("mesh 84x80", MODEL)},
    **{f"reading {name}": (f"{name} strains", MODEL) for name in ("von-karman", "sanders", "donnell")},
    "reading face area": ("pressure on the inner face, dead", MODEL),
    "reading follower": ("pressure on the inner face, following", MODEL),
    "reading full-3d": ("full three-dimensional law", MODEL),
    "reading consistent": ("nodal forces by consistent coupling", MODEL),
}
DATUM = {"gamma_deg": "cord angle {} deg", "ply_thickness_mm": "ply {} mm thick", "p0_MPa": "inflated by {} MPa"}
CELLS = (*(cell for cell in TYRE if cell.label in WORDS), *READINGS)
IMAGES = {  # of maps with phi along the rows: psi reversed, phi reversed
    "central: p(psi, phi) - p(-psi, -phi)": (True, True),
    "mirror: p(psi, phi) - p(-psi, phi)": (True, False),
    "mirror: p(psi, phi) - p(psi, -phi)": (False, True),
}


def tyre_comparison(answers: Answers) -> dict[str, pd.DataFrame]:
    """Two tables: COLUMNS, a row a reading; SYMMETRY_COLUMNS, both against their images.

    own_sum_N, printed_sum_N: pressures times mid-surface areas.  handedness: correlation of the mirror-odd parts.
    """
    rows: list[dict[str, Any]] = []
    printed = printed_map()
    symmetry = [("printed", math.nan, *row) for row in asymmetries(printed)]
    for answer in answers.those(PAPER):
        maps = pressure_maps(answer)
        reads = [(delta, HALF, on_printed_nodes(own, printed, HALF)) for delta, own in maps.items()]
        for delta, _, read in reads:
            symmetry += [("ours", delta, *row) for row in asymmetries(read)]
        if DELTA in maps:
            reads.append((DELTA, LITERAL, on_printed_nodes(maps[DELTA], printed, LITERAL)))
        for delta, per_label, read in reads:
            row = {"own_sum_N": force(read, per_label, answer.settings), "handedness": handedness(read, printed)}
            rows.append(row | beside_printed(answer, delta, per_label, read, printed))
    return {
        "tyre_comparison": pd.DataFrame(rows, columns=list(COLUMNS)),
        "tyre_symmetry": pd.DataFrame(symmetry, columns=list(SYMMETRY_COLUMNS)),
    }


def tyre_readings(answers: Answers) -> pd.DataFrame:
    """READING_COLUMNS, a row a reading and travel; stated: at DELTA; best: the smallest core rms of its reading.

    kind: whether the model is changed or a datum within its rounding.  printed_sum_N: printed pressures times the areas
    of their nodes on the wall of that reading.  The other numbers are those of ``compare``.
    """
    printed = printed_map()
    rows = []
    for answer in answers.those(CELLS):
        reading, kind = words(answer.label)
        named = {"reading": reading, "kind": kind, "label": answer.label, "command": answer.command}
        for delta, own in pressure_maps(answer).items():
            beside = beside_printed(answer, delta, HALF, on_printed_nodes(own, printed, HALF), printed)
            rows.append({**named, **beside, "stated": delta == DELTA})
    readings = pd.DataFrame(rows, columns=list(READING_COLUMNS))
    return readings.assign(best=readings.index.isin(readings.groupby("label", sort=False)["core_rms"].idxmin()))


def words(label: str) -> tuple[str, str]:
    """A reading in words, and its kind, by the label of its cell."""
    if label in WORDS:
        return WORDS[label]
    key, value = label.removeprefix("reading ").split()
    return DATUM[key].format(value), DATA


def pressure_maps(answer: Answer) -> dict[float, pd.DataFrame]:
    """Computed pressures by phi (rows) and psi, for each travel; NaN out of contact."""
    contact = answer.table("contact")
    angles = {name: contact[f"{name}_deg"].round(ANGLE_DECIMALS) + 0.0 for name in ("psi", "phi")}
    contact = contact.assign(**angles, pressure=contact["pressure_MPa"].where(contact["active"] == 1))
    maps = {}
    for delta in sorted(contact["delta_mm"].unique().tolist()):
        own = contact[contact["delta_mm"] == delta].pivot(index="phi", columns="psi", values="pressure")
        maps[delta] = own.sort_index().sort_index(axis=1)
    return maps


def beside_printed(
    answer: Answer, delta: float, per_label: float, own: pd.DataFrame, printed: pd.DataFrame
) -> dict[str, Any]:
    """A reading at a travel: what ``compare`` finds, the force of the plane, and the sum of the printed pressures."""
    printed_sum = force(printed, per_label, answer.settings)
    row = {"delta_mm": delta, "phi_per_label": per_label, **compare(own, printed), "printed_sum_N": printed_sum}
    return {**row, "force_N": answer.value("force_N", delta_mm=delta)}


def printed_map() -> pd.DataFrame:
    """The printed table in MPa."""
    by_label = read_reference(FILE).set_index("row_label").rename(index=float, columns=float) / PRINTED_FACTOR
    return by_label.sort_index().sort_index(axis=1).rename_axis(columns="psi")


def on_printed_nodes(computed: pd.DataFrame, printed: pd.DataFrame, phi_per_label: float) -> pd.DataFrame:
    """A computed map at the printed places; NaN off the patch and off the mesh."""
    phi = [round(float(label) * phi_per_label, ANGLE_DECIMALS) + 0.0 for label in printed.index]
    places = computed.reindex(index=pd.Index(phi), columns=printed.columns)
    places.index = printed.index
    return places


def core(patch: np.ndarray, depth: int = DEPTH) -> np.ndarray:
    """The nodes of a patch whose ``depth`` neighbours along both directions, both ways, belong to it, too.

    Outside the table nothing belongs to the patch.
    """
    cross = np.zeros((2 * depth + 1, 2 * depth + 1), bool)
    cross[depth] = cross[:, depth] = True
    return np.asarray(binary_erosion(patch, cross))


def compare(computed: pd.DataFrame, printed: pd.DataFrame) -> dict[str, float]:
    """Centre pressures [MPa], rms of (computed - printed)/printed over the core, node counts, of the same places.

    core_rms: NaN when no core node touches in ours.  in_one_only: nodes of exactly one patch.  outside: printed entries
    off the computed patch.
    """
    ours, theirs = computed.to_numpy(dtype=float), printed.to_numpy(dtype=float)
    here, there = ~np.isnan(ours), ~np.isnan(theirs)
    inside = core(there) & here
    relative = ours[inside] / theirs[inside] - 1.0
    middle = (int(np.argmin(np.abs(printed.index))), int(np.argmin(np.abs(printed.columns))))
    nodes, printed_nodes, both = (int(each.sum()) for each in (here, there, here & there))
    return {
        "centre_MPa": float(np.nan_to_num(ours[middle])),
        "printed_centre_MPa": float(theirs[middle]),
        "core_rms": float(np.sqrt(np.mean(relative**2))) if inside.any() else math.nan,
        "printed_nodes": printed_nodes,
        "in_one_only": nodes + printed_nodes - 2 * both,
        "outside": printed_nodes - both,
    }


def force(pressures: pd.DataFrame, phi_per_label: float, settings: Mapping[str, Any]) -> float:
    """Sum of pressures times mid-surface nodal areas [N]: dpsi dphi A1 A2 zeta1 zeta2 of the torus at half thickness.

    The tube's inner face, radius R1 about a circle of radius R0 - R1 [mm], is the reference surface of the tyre.
    """
    psi = np.deg2rad(np.asarray(pressures.columns, dtype=float))
    labels = np.asarray(pressures.index, dtype=float)
    dpsi, dphi = psi[1] - psi[0], np.deg2rad((labels[1] - labels[0]) * phi_per_label)
    inner = torus(settings["R0_mm"] - settings["R1_mm"], settings["R1_mm"]).geometry(psi, np.zeros_like(psi))
    areas = dpsi * dphi * area_factor(inner, 0.5 * settings["plies"] * settings["ply_thickness_mm"])
    return float(np.sum(np.nan_to_num(pressures.to_numpy(dtype=float)) * areas))


def asymmetries(pressures: pd.DataFrame) -> Iterator[tuple[str, float]]:
    """Each image with the largest difference from it [MPa] over pairs of nodes that both touch."""
    p = pressures.to_numpy(dtype=float).T
    for name, (psi, phi) in IMAGES.items():
        yield name, deviation(np.nan_to_num(p), ~np.isnan(p), psi=psi, phi=phi, periodic=False)


def handedness(computed: pd.DataFrame, printed: pd.DataFrame) -> float:
    """Correlation of the mirror-odd parts of two maps where both and their mirror images touch.

    Positive when the pressures of both turn the same way, near -1 when one is the mirror image of the other.
    """
    odd = [p - p[:, ::-1] for p in (computed.to_numpy(dtype=float), printed.to_numpy(dtype=float))]
    both = ~np.isnan(odd[0]) & ~np.isnan(odd[1])
    if both.sum() < 2 or not all(np.ptp(each[both]) > 0 for each in odd):
        return math.nan
    return float(np.corrcoef(odd[0][both], odd[1][both])[0, 1])
