"""The parameters of the contact algorithms as settings, which a scene has beside its own."""

from __future__ import annotations

from collections.abc import Mapping

from contact import parameters
from contact.algorithms.base import frictionless_parameters, require_friction
from contact.catalogue import ALGORITHMS
from contact.newton.step import RESIDUAL_TOLERANCE
from contact.problem import ContactAlgorithm
from studies.ask.friction_settings import MU
from studies.ask.friction_settings import settings_of as friction_settings
from studies.ask.request import Value
from studies.ask.scene import Scene, Setting, SlidingScene, has_contact

TOLERANCE = Setting.of(parameters.TOLERANCE, RESIDUAL_TOLERANCE)


def settings_beside(scene: Scene) -> tuple[Setting, ...]:
    """What every scene has beside its own settings and those of an algorithm."""
    return (TOLERANCE, *(friction_settings(slides=isinstance(scene, SlidingScene)) if has_contact(scene) else ()))


def parameters_of(contact: str) -> tuple[Setting, ...]:
    """All parameters of an algorithm as settings, with its own defaults."""
    algorithm = ALGORITHMS[contact]
    return tuple(Setting.of(parameter, getattr(algorithm, parameter.key)) for parameter in algorithm.parameters)


def settings_of(contact: str) -> tuple[Setting, ...]:
    """Those that no scene has; none for an unknown name."""
    shared = {parameter.key for parameter in parameters.SHARED}
    own = parameters_of(contact) if contact in ALGORITHMS else ()
    return tuple(setting for setting in own if setting.key not in shared)


def without_friction(contact: str) -> tuple[str, ...]:
    """Those that no scene has and that the algorithm has without friction alone."""
    return frictionless_parameters(ALGORITHMS[contact]) if contact in ALGORITHMS else ()


def own_keys() -> tuple[str, ...]:
    """Of the settings that some algorithm of the catalogue has for itself."""
    return tuple(dict.fromkeys(setting.key for contact in ALGORITHMS for setting in settings_of(contact)))


def configured(contact: str, settings: Mapping[str, Value]) -> ContactAlgorithm:
    """The algorithm with those of the settings that it has; raises ValueError for a value that it cannot have.

    With a coefficient of friction among them it has to know friction, and so has each of its settings.
    """
    algorithm = ALGORITHMS[contact]
    found = algorithm(**{p.key: settings[p.key] for p in algorithm.parameters if p.key in settings})
    if MU.key in settings:
        require_friction(found)
    return found
