"""The catalogue of scenes: names without loading anything, and every declaration in its scene's own module."""

from __future__ import annotations

import importlib

import pytest

from studies.ask.scene import judged_of, ladders_of
from studies.run.campaigns.ladder_cells import BENCHMARKS, LADDERS
from studies.scenes import MODULES, SCENES


@pytest.mark.parametrize("module", dict.fromkeys(MODULES.values()))
def test_a_module_offers_the_scenes_that_the_catalogue_names(module: str) -> None:
    offered = [scene.name for scene in importlib.import_module(module).SCENES]
    assert offered == [name for name, where in MODULES.items() if where == module]
    assert all(SCENES[name].name == name and type(SCENES[name]).__module__ == module for name in offered)


def test_all_ladders_that_scenes_declare_are_climbed() -> None:
    declared = [ladder for name in MODULES for ladder in ladders_of(SCENES[name])]
    climbed = (*LADDERS, *BENCHMARKS)
    assert len(climbed) == len(declared)
    assert all(ladder in climbed for ladder in declared)


@pytest.mark.parametrize("name", MODULES)
def test_a_default_as_it_is_printed_asks_for_the_same_problem(name: str) -> None:
    for setting in SCENES[name].settings:
        if setting.default is not None:
            assert setting.parse(setting.default_text) == setting.parse(setting.default)


@pytest.mark.parametrize("name", MODULES)
def test_a_scene_says_what_it_is_judged_by(name: str) -> None:
    scene = SCENES[name]
    declared: dict[str, str] = getattr(scene, "quantities", {})
    anywhere = ("force_N", "limit_load_fraction")
    for quantity in judged_of(scene):
        assert quantity in anywhere or quantity.removeprefix("limit_") in declared
