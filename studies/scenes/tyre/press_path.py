"""How the press of a tyre is followed: by steps of the travel, or by arc length through its limit points."""

from __future__ import annotations

from contact.continuation.arc_length import ArcLength
from contact.continuation.turning_points import EASY, HARD
from studies.ask.request import Request
from studies.ask.scene import Setting, UsageError

FIRST = 1.0  # mm, over the number of steps
LARGEST = 4.0  # of the first step
MOST_POINTS = 60
PATH = Setting.one_of(
    "path", ("travel", "arc"), None, "steps of the travel, or arc length through limit points", otherwise="travel"
)
ARC_POINTS = Setting("arc_points", None, "points of the curve, with path=arc", "int", 1, 10_000, otherwise="60")
SETTINGS = (PATH, ARC_POINTS)


def arc_of(request: Request) -> ArcLength | None:
    """The continuation, or None for steps of the travel; raises UsageError for points of no curve."""
    settings = request.settings
    if settings.get("path", "travel") == "travel":
        if "arc_points" in settings:
            raise UsageError("arc_points belongs to path=arc")
        return None
    points = int(settings.number("arc_points")) if "arc_points" in settings else MOST_POINTS
    tolerance = request.number("tolerance")
    first = FIRST / request.steps
    return ArcLength(first, EASY, HARD, largest=LARGEST, max_points=points, tolerance=tolerance, lowest=0.0)
