"""Scenes with friction by every algorithm against quantities written down once: whatever is rebuilt, they stay."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from studies.scenes.complete import complete
from studies.solving.result import unit_of
from studies.solving.solve import solve

GOLDEN = json.loads(Path(__file__).with_name("golden.json").read_text(encoding="utf-8"))
EXACT = 1e-9  # of the largest in a unit: what the tolerance of Newton's iteration leaves
CASES: dict[str, tuple[str, dict[str, Any], str]] = {
    "panel, dragged": ("panel", {"shape": "plate", "mu": 0.2, "delta_mm": 0.5, "drag_mm": (0.2, 0.5)}, "6x6"),
    "panel, turned": (
        "panel",
        {"shape": "plate", "mu": 0.2, "foundation": "ball", "ball_mm": 400.0, "delta_mm": 2.0, "turn_deg": (0.5, 5.0)},
        "6x6",
    ),
    "ring": ("ring", {"mu": 0.3}, "12x2"),
    "tyre": ("tyre", {"mu": 0.5, "delta_mm": (4.0, 8.0), "drag_mm": (1.0, 8.0)}, "10x8"),
}
FAST = [case for case in GOLDEN if case.startswith("semismooth: ") or case.endswith(": panel, dragged")]
SLOW = [pytest.param(case, marks=pytest.mark.slow) for case in GOLDEN if case not in FAST]


@pytest.mark.parametrize("case", [*FAST, *SLOW])
def test_a_scene_is_what_it_was(case: str) -> None:
    contact, _, name = case.partition(": ")
    scene, settings, mesh = CASES[name]
    wanted, actual = GOLDEN[case], solve(*complete(scene, settings, mesh, contact=contact))
    assert actual.verdict == wanted["verdict"]
    assert [step.counters["newton_iterations"] for step in actual.loads] == wanted["iterations"]
    for step, kept in zip(actual.loads, wanted["loads"], strict=True):
        for quantity, value in step.quantities.items():
            unit = unit_of(quantity)
            size = max(abs(other) for key, other in kept.items() if unit_of(key) == unit) if unit[0] == "_" else 1.0
            if quantity.startswith("moment"):  # without friction rounding of forces a millimetre apart
                size = max(size, abs(kept.get("force_N", 0.0)))
            assert value == pytest.approx(kept[quantity], rel=EXACT, abs=EXACT * size), quantity
