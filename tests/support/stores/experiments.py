"""Made-up tables of experiments: faces, crushed rings, walls and other programs, whose errors and limits are chosen."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pandas as pd

from studies.bench.programs import explained
from studies.experiments.shell_limits.bodies import DEFAULT, FULL_3D, THREE
from studies.experiments.shell_limits.ladder import COLUMNS
from studies.experiments.solid_laws import BENDING, HALF_DIGIT, INPUTS, MEMBRANE, MESHES, SHELLS, SOLIDS, STATES
from studies.scenes.contact.crushed_ring import FILE
from studies.scenes.data import read_reference

SIDES, QUANTITY, EXACT, LOST = (8, 16, 32), "P_over_ER", 2.0, "two rings"
PROBLEMS = {LOST: ("first", "second"), "ring on itself": ("first",)}
NAMES = ("semismooth", "qp", "regularised")
PLANE_S = 0.04


def made_up_faces() -> dict[str, pd.DataFrame]:
    """All tables of the page by name."""
    own = {"faces": pairings(), "faces_algorithms": algorithms(), "faces_cost": cost()}
    return own | {"faces_spheres": spheres(), "faces_ironing": ironed()}


def pairings() -> pd.DataFrame:
    """The second as slave has an error of the other sign."""
    rows = []
    for (problem, slaves), n, pairing in product(PROBLEMS.items(), SIDES, ("nodes", "mortar")):
        for sign, slave in zip((1, -1), slaves, strict=False):
            lost = problem == LOST and pairing == "nodes" and n == SIDES[-1]
            error = math.nan if lost else sign / n ** (2 if pairing == "mortar" else 1)
            said = {"problem": problem, "scene": "two-rings", "mesh": f"1x{n}", "pairing": pairing, "slave": slave}
            by_name = {"quantity": QUANTITY, "value": EXACT * (1 + error), "reference": EXACT, "error": error}
            ended = {"outcome": "cap-hit" if lost else "converged", "reason": "it is made up" if lost else ""}
            command = f"footprint solve two-rings --mesh 1x{n} --set pairing={pairing} --set slave={slave} {problem!r}"
            both = math.nan if len(slaves) == 1 or lost else 2 * abs(error)
            ended |= {"finest": n == SIDES[-1], "bias": both}
            spent = {"known": 3e-4, "iterations": 9, "unknowns": 14 * n, "cpu_s": 0.1}
            rows.append({**said, **by_name, **spent, **ended, "command": command})
    return pd.DataFrame(rows)


def algorithms() -> pd.DataFrame:
    """Springs differ, and qp refuses one of two cases."""
    rows = []
    for case, name in product(PROBLEMS, NAMES):
        refused = case == LOST and name == "qp"
        outcome = "unsupported" if refused else "converged"
        error = math.nan if refused else {"semismooth": 0.0, "qp": 1e-12, "regularised": 1e-3}[name]
        row = {"case": case, "algorithm": name, "outcome": outcome, "reason": "made up" if refused else ""}
        spent = {"iterations": 10, "substeps": 3 if name == "regularised" else 2, "command": f"{case} {name}"}
        rows.append({**row, **spent, "loads": 2, "judged": 2, "force_error": error})
    return pd.DataFrame(rows)


def cost() -> pd.DataFrame:
    """Nodes cost as much as the plane, mortar half as much again."""
    kinds = {"rigid plane": ("ring", 1.0), "nodes": ("two-rings", 1.0), "mortar": ("two-rings", 1.5)}
    return pd.DataFrame(
        [
            {"scene": scene, "pairing": name, "size": size, "unknowns": n, "cpu_s": PLANE_S * ratio, "ratio": ratio}
            for size, n in enumerate((640, 1280))
            for name, (scene, ratio) in kinds.items()
        ]
    )


def spheres() -> pd.DataFrame:
    """Facets end at 2 mm of 5, curved faces do not."""
    rows = []
    for faces, mesh, delta in product(("facets", "curved"), ("30x1", "80x1"), range(1, 6)):
        ends = faces == "facets" and delta > 2
        ended = {
            "outcome": "given-up" if faces == "facets" else "converged",
            "reason": "",
            "command": f"{faces} {mesh}",
        }
        row = {"faces": faces, "mesh": mesh, "delta_mm": delta, "quarter_N": math.nan if ends else 0.4 * delta}
        rows.append({**row, "reference": 0.4 * delta, "known": 0.05, "iterations": 40, "cpu_s": 9.0, **ended})
    return pd.DataFrame(rows)


def ironed() -> pd.DataFrame:
    """Errors of order 1 in H = 140; the shell has half of them, and is not solved on the finest mesh."""
    rows = []
    for (n, error), slab in product(((30, 0.4), (60, 0.2), (120, 0.1)), ("solid", "shell")):
        if (n, slab) == (120, "shell"):
            continue
        V, H = 400.0, 140 * (1 + (error if slab == "solid" else error / 2))
        record = {"slab": slab, "mesh": f"1x{n}", "V_press": 0.8 * V, "H_press": 0.5 * H, "V": V, "H": H}
        rows.append({**record, "ratio": H / V, "ripple": 0.1 * error, "states": 100})
    return pd.DataFrame(rows)


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


OF_WALLS = {"bad": 1.0, "better": 0.1, "best": 0.0}


def made_up_walls() -> pd.DataFrame:
    """Three cases, their shells of two laws and a straight solid; the solid costs seven times the shell."""
    rows = []
    for case, factor in OF_WALLS.items():
        for ratio in (0.01, 0.03, 0.1, 0.5):
            own = {"case": case, "scene": "", "quantity": "w", "thickness": "h/R", "ratio": ratio, "known_to": 1e-6}
            own |= {"exact": 1.0, "solid_against_exact": 1e-5, "fails": f"why it is {case}", "shell_unknowns": 10}
            own |= {"solid_unknowns": 50, "shell_seconds": 1.0, "solid_seconds": 7.0}
            rows += [{**own, "variant": name, "error": factor * ratio**2} for name in (DEFAULT, FULL_3D.name)]
            rows += [{**own, "variant": THREE.name, "error": factor * ratio**3, "shell_seconds": 2.0}]
    return pd.DataFrame(rows, columns=list(COLUMNS))


COARSE, FINE = "8x8", "16x16"
# case: quantity, ours, difference on the coarse and on the fine mesh, the same to our solid under the rule of plies
CHOSEN = {
    "hemisphere": ("inward_mm", 8.0, -0.08, -0.02, np.nan),
    "tyre, isotropic": ("force_N", 520.0, 0.02, 0.005, np.nan),
    "tyre, angle plies, inflated": ("inflated_equator_outer_mm", -1.8, 0.4, 0.2, 0.01),
    "ring": ("force_N", 10.0, 0.02, 0.03, np.nan),
}


def made_up_programs() -> pd.DataFrame:
    """A row a case and mesh, judged as those that were run."""
    rows = []
    for case, (quantity, ours, *differences, held) in CHOSEN.items():
        for mesh, difference in zip((COARSE, FINE), differences, strict=True):
            theirs = ours * (1 + difference)
            rows.append(
                {
                    **{"case": case, "scene": case.split(",")[0], "settings": "", "measure": "exact", "mesh": mesh},
                    **{
                        "program": "CalculiX",
                        "version": "ccx 2.20",
                        "elements": "C3D20R",
                        "nodes": 5000,
                        "seconds": 12.5,
                    },
                    **{"bricks": int(mesh.split("x")[0]) ** 2, "our_mesh": "32x32", "held": theirs / (1 + held)},
                    **{"quantity": quantity, "step": 0, "load": 1.0, "theirs": theirs, "ours": ours},
                    **{"difference": difference, "reference": np.nan, "source": ""},
                }
            )
    return explained(pd.DataFrame(rows))
