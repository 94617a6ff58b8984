"""Scenes as functions of their settings, whose names, types and defaults a notebook or an interpreter completes.

Nothing is solved, checked or described here: that is :mod:`studies.notebook`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from inspect import Parameter, Signature, signature
from typing import Any, Literal

from studies.ask.scene import Setting, settings_beside
from studies.ask.settings import parameters_of
from studies.catalogue.descriptions import describe
from studies.scenes import SCENES

KINDS: dict[str, Any] = {"float": float, "int": int, "floats": Sequence[float], "path": Sequence[float]}


class Scenes:
    """``scene.two_rings(delta_mm=50, mesh="1x20")`` is ``solve("two-rings", delta_mm=50, mesh="1x20")``.

    Each function has the options of ``solve``, the settings of its scene, and those of the algorithm in ``contact`` by
    default.
    """

    def __init__(self, solve: Callable[..., Any]) -> None:
        """solve: :func:`studies.notebook.solve`, which loads more than is known here."""
        self._solve = solve

    def __dir__(self) -> list[str]:
        return [name.replace("-", "_") for name in SCENES]

    def __getattr__(self, name: str) -> Callable[..., Any]:
        scene = next((each for each in SCENES if each.replace("-", "_") == name), None)
        if scene is None:
            raise AttributeError(f"no scene {name!r}: footprint list scenes")

        def solved(**given: Any) -> Any:
            return self._solve(scene, **given)

        solved.__name__, solved.__doc__ = name, describe(scene).text
        solved.__signature__ = self._signature(scene)  # type: ignore[attr-defined]  # what inspect reads
        return solved

    def _signature(self, name: str) -> Signature:
        options = [each for each in signature(self._solve).parameters.values() if each.kind is Parameter.KEYWORD_ONLY]
        contact = next(each.default for each in options if each.name == "contact")
        scene, taken = SCENES[name], {each.name for each in options}
        settings = {each.key: each for each in (*scene.settings, *settings_beside(scene), *parameters_of(contact))}
        return Signature([*options, *(_keyword(each) for key, each in settings.items() if key not in taken)])


def _keyword(setting: Setting) -> Parameter:
    kind = Literal[tuple(setting.choices)] if setting.kind == "choice" else KINDS[setting.kind]
    return Parameter(setting.key, Parameter.KEYWORD_ONLY, default=setting.default, annotation=kind)
