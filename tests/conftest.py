"""Fixtures of all tests: a seeded generator and the patches."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.shells import PATCHES, Patch


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Under ``--dist loadgroup`` a file stays on one worker, and all pages on one that makes their store once."""
    for item in items:
        pages = (Path(__file__).parent / "reports") in item.path.parents
        item.add_marker(pytest.mark.xdist_group("reports" if pages else str(item.path)))


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2004)


@pytest.fixture(params=PATCHES)
def patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


@pytest.fixture(params=[name for name in PATCHES if name != "plate"])
def curved_patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]
