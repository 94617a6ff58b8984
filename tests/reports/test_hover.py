"""Points of a picture tell their values; found by their places, so every one must be found, and no other."""

from __future__ import annotations

import re

import numpy as np

from reports.figures import drawing
from reports.figures.drawing import canvas, svg, ticks


def drawn(log: bool = False, count: int = 3, label: str = "one") -> str:
    @svg
    def picture():
        figure, (first, second) = canvas(2)
        first.plot(np.arange(1, count + 1), np.arange(1, count + 1) ** 2.0, "o-", label=label)
        first.plot([1, 2], [7.123456, np.nan], "x-")
        first.plot([0, 5], [0, 5])
        first.set_xlabel("travel [mm]")
        first.set_ylabel("force\n[N]")
        if log:
            first.set_yscale("log")
        second.scatter([0, 1], [5, 6], label="cloud")
        ticks(second, [0, 1], ["plain", "mixed"])
        return figure

    return picture()()


def test_every_point_of_a_line_and_of_a_cloud_has_its_values() -> None:
    for log in (False, True):
        titles = re.findall(r"<title>(.*?)</title>", drawn(log))
        assert titles == [
            *(f"one: travel [mm] {x}, force [N] {x * x}" for x in (1, 2, 3)),
            "travel [mm] 1, force [N] 7.123",
            *("cloud: plain, 5", "cloud: mixed, 6"),
        ]


def test_of_too_many_points_the_named_ones_have_theirs(monkeypatch) -> None:
    monkeypatch.setattr(drawing, "MOST", 5)
    assert len(re.findall("<title>", drawn())) == 5
    monkeypatch.setattr(drawing, "MOST", 4)
    assert re.findall("<title>(.*?),", drawn(label="_hidden")) == ["cloud: plain", "cloud: mixed"]
