"""A made-up table of other programs: differences to ours are chosen, those of meshes fall with the second order."""

from __future__ import annotations

import numpy as np
import pandas as pd

from studies.bench.programs import explained

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
