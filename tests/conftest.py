"""Fixtures of all tests: a seeded generator, the patches, and catalogues that plug-ins leave as they were."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator

import numpy as np
import pytest
from xdist.scheduler import LoadFileScheduling

from studies.scenes import plugins
from support.problems.shells import PATCHES, Patch

SHARED = ("tests/reports", "tests/studies/gate", "tests/studies/run")  # folders that share a store that costs seconds


class ByFile(LoadFileScheduling):
    """A worker a file, but one for all files that share a store."""

    def _split_scope(self, nodeid: str) -> str:
        shared = (folder for folder in SHARED if nodeid.startswith(f"{folder}/"))
        return next(shared, super()._split_scope(nodeid))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> ByFile:
    return ByFile(config, log)


def pytest_collection_finish() -> None:
    """What was collected stays to the end: to look for garbage in it takes a twentieth of the time of all tests."""
    gc.freeze()
    gc.set_threshold(100_000, 50, 50)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2004)


@pytest.fixture(params=PATCHES)
def patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


@pytest.fixture(params=[name for name in PATCHES if name != "plate"])
def curved_patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


@pytest.fixture(autouse=True)
def no_files_in_use(monkeypatch: pytest.MonkeyPatch) -> None:
    """Files that another test in this process has used are in no command that is printed here."""
    monkeypatch.setattr(plugins, "_used", [])


@pytest.fixture
def put_back(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """What is run in this process leaves catalogues and modules as they were."""
    known, modules = {group: dict(parts) for group, parts in plugins.GROUPS.items()}, set(sys.modules)
    monkeypatch.setattr(sys, "path", [*sys.path])
    yield
    for group, parts in plugins.GROUPS.items():
        parts.clear()
        parts.update(known[group])
    for name in {"stranger", "broken", "half"} & sys.modules.keys() - modules:
        del sys.modules[name]
