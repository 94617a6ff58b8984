"""The settings of Coulomb friction, which every scene with contact has beside its own. Nothing is solved here."""

from __future__ import annotations

from collections.abc import Mapping

from studies.ask.request import UsageError, Value
from studies.ask.scene import Setting

MU = Setting("mu", None, "Coulomb's coefficient of friction", low=0, infinite=True, otherwise="0: no friction")
STOPS = "stops of the foundation on its way {} once it has pressed, in turn"
DRAG = Setting("drag_mm", None, STOPS.format("along itself"), "path", otherwise="it is not dragged")
WAY = Setting(
    "drag_deg",
    None,
    "direction of the drag in the tangent plane",
    low=-360,
    high=360,
    otherwise="0",
)
TURN = Setting("turn_deg", None, STOPS.format("around its normal, after the drag,"), "path", otherwise="no turn")
SLIDING = (DRAG, WAY, TURN)


def settings_of(*, slides: bool) -> tuple[Setting, ...]:
    """What a scene with contact has beside its own; a foundation is dragged where a whole body lies on it."""
    return (MU, *SLIDING) if slides else (MU,)


def completed(settings: Mapping[str, Value]) -> dict[str, Value]:
    """The settings without a coefficient of 0: that of no friction; raises UsageError on a drag without one."""
    if settings.get(MU.key, 0.0) != 0.0:
        return dict(settings)
    vain = [setting.key for setting in SLIDING if setting.key in settings]
    if vain:
        raise UsageError(f"{vain[0]} needs a coefficient of friction: mu above 0")
    return {key: value for key, value in settings.items() if key != MU.key}


def rubbing(settings: Mapping[str, Value]) -> bool:
    """Whether a request has friction."""
    return MU.key in settings
