"""Bodies of the tables in space: where they are seen from, how much their motion is magnified, what lies on them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from reports.figures.relief import View

X, DOWN_X, Z = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
VIEWS: Mapping[str, tuple[tuple[float, float, float], float, float]] = {  # by how a scene's name begins
    "tyre-solid": (DOWN_X, -40.0, 14.0),
    "tyre": (DOWN_X, 42.0, 14.0),
    "hemisphere": (Z, 28.0, 24.0),
    "sze-pullout": (X, 35.0, 24.0),
    "sze-pinched": (X, 35.0, 24.0),
    "semicylinder": (X, 40.0, 24.0),
    "roof": (X, 50.0, 24.0),
    "scordelis-lo": (X, 40.0, 28.0),
    "pinched-cylinder": (X, 35.0, 24.0),
    "pressurised-cylinder": (X, 40.0, 28.0),
    "pressurised-sphere": (X, 40.0, 28.0),
    "pressurised-torus": (Z, -62.0, 22.0),
    "free-hyperboloid": (Z, 25.0, 22.0),
    "ring": (DOWN_X, -62.0, 14.0),
    "crushed-ring": (DOWN_X, -62.0, 14.0),
    "panel": (X, 40.0, 28.0),
    "manufactured": (X, 40.0, 28.0),
}
BY_DEFAULT = (Z, -55.0, 26.0)
SMALL, SHOWN = 0.028, 0.12  # motions below the one share of the size of a body are shown as about the other
FROM_BELOW = View.of(DOWN_X, 42.0, -24.0)  # of the tyre, so that its patch is seen


def view_of(scene: str) -> View:
    """The fixed view of a scene."""
    found = next((name for name in VIEWS if scene == name or scene.startswith(f"{name}-")), "")
    return View.of(*VIEWS.get(found, BY_DEFAULT))


@dataclass(frozen=True, eq=False)
class Body:
    """Points at rest (n, 3) with displacement and pressure, and the quadrilaterals (q, 4) of its skin."""

    rest: np.ndarray
    u: np.ndarray
    pressure: np.ndarray
    quads: np.ndarray

    @property
    def size(self) -> float:
        """Diagonal of its box."""
        return float(np.linalg.norm(np.ptp(self.rest, axis=0)))

    @property
    def moved(self) -> np.ndarray:
        """Length of the displacements (n,)."""
        return np.asarray(np.linalg.norm(self.u, axis=1))

    @property
    def magnified(self) -> float:
        """1, or for small motions a round number that shows them."""
        largest = float(self.moved.max())
        if largest == 0 or largest > SMALL * self.size:
            return 1.0
        wanted = SHOWN * self.size / largest
        power = 10.0 ** math.floor(math.log10(wanted))
        return next(power * digit for digit in (5, 2, 1) if power * digit <= wanted)
