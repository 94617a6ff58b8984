"""The tyres that pages compare, by what was asked for: keywords of ``store.find`` and ``store.select``."""

from __future__ import annotations

import math
from typing import Any

Asked = dict[str, Any]
DELTA = 20.0  # mm, the travel of the printed table
CURVES = (10.0, 15.0, DELTA)  # mm, travels of the cell PAPER that are drawn; without them there is no page
TO_DELTA = (5, 10, 15, DELTA)

ELEMENT: Asked = {"scene": "tyre", "membrane": "compatible", "thickness_strain": "projected"}  # the paper's
USUAL: Asked = {"contact": "semismooth", "newton": "mixed", "epsilon": math.inf}  # the other algorithms' yardstick
WHOLE: Asked = {**ELEMENT, "model": "full", "plies": 4, "section": "constant-s33"}
PAPER: Asked = {**WHOLE, **USUAL, "mesh": "42x40", "measure": "exact", "delta_mm": (5, 10, 15, *range(20, 28))}
ISOTROPIC_FINE: Asked = {**ELEMENT, "mesh": "84x80", "model": "full", "plies": 1, "delta_mm": TO_DELTA}
PLIES = {"angle plies": 4, "isotropic": 1}  # by their words in the table tyre_models
