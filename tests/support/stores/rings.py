"""Made-up studies of the crushed ring and of laws: limits are chosen, meshes leave an error of the second order."""

from __future__ import annotations

import pandas as pd

from studies.experiments.solid_laws import BENDING, HALF_DIGIT, INPUTS, MEMBRANE, MESHES, SHELLS, SOLIDS, STATES
from studies.scenes.contact.crushed_ring import FILE
from studies.scenes.data import read_reference

FACTORS = {  # limits over the measured force
    **{"solid svk": 0.9, "solid hencky": 1.02, "solid neo-hooke": 1.0},
    **{"shell exact": 0.91, "shell von-karman": 0.85, "shell exact, ν = 0": 0.92, "shell von-karman, ν = 0": 1.01},
}
LEFT = 100.0  # N: the error of a mesh is LEFT h^2
SLOPES = {"E_MPa": 0.1, "nu": 0.2, "outer_mm": -0.3, "inner_mm": 0.4}  # relative change of the force by a half digit


def made_up_ring() -> pd.DataFrame:
    """All studies."""
    rows = []
    for delta, measured in zip(*(read_reference(FILE)[name] for name in ("delta_mm", "measured_N")), strict=True):
        at = {"delta_mm": delta, "least_stretch": 0.8, "largest_stretch": 1.2, "command": "footprint solve"}
        for body in (*SOLIDS, *SHELLS):
            own = {"body": body.name, "kind": body.kind, "of": body.of, "input": "", "change": None, **at}
            for n in (16, 32, 64):
                force = FACTORS[body.name] * measured + LEFT / n**2
                rows.append({"study": MESHES, **own, "mesh": f"1x{n}", "size": 1 / n, "force_N": force})
        own = {"body": "shell exact", "kind": "shell", "of": "exact", "mesh": "1x16", "size": 1 / 16, **at}
        for key, half in HALF_DIGIT.items():
            for sign in (-1, 1):
                force = measured * (1 + sign * SLOPES[key])
                rows.append({"study": INPUTS, **own, "input": key, "change": sign * half, "force_N": force})
        first = FACTORS["solid hencky"] * measured + LEFT / 16**2
        rows.append({"study": STATES, **own, "body": "solid hencky", "input": "3d", "force_N": 0.75 * first})
    order = {study: i for i, study in enumerate((MESHES, INPUTS, STATES))}
    table = pd.DataFrame(rows)
    names = [body.name for body in (*SOLIDS, *SHELLS)]
    by = table.assign(a=table["study"].map(order), b=table["body"].map(names.index), c=-table["size"])
    return by.sort_values(["a", "b", "c", "delta_mm"], kind="stable").drop(columns=["a", "b", "c"])


def made_up_laws() -> pd.DataFrame:
    """A membrane that the law changes by 2 e and a strip that it changes by e^2."""
    rows = []
    for name, carries, factor, power in (("balloon", MEMBRANE, 2.0, 1.0), ("strip", BENDING, 1.0, 2.0)):
        for load, strain in ((1.0, 0.01), (2.0, 0.1)):
            for law, change in (("svk", 0.0), ("hencky", factor)):
                value = 1 / (1 + change * strain**power)
                own = {"specimen": name, "carries": carries, "quantity": "growth", "load": load, "law": law}
                rows.append({**own, "value": value, "strain": strain})
    return pd.DataFrame(rows)
