"""Fixtures of all tests: a seeded generator and the patches."""

from __future__ import annotations

import numpy as np
import pytest

from support.shells import PATCHES, Patch


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """One worker a file, and one for all pages: what is solved or rendered once is not solved again by its side."""
    for item in items:
        folder = item.path.parent.name
        item.add_marker(pytest.mark.xdist_group(folder if folder == "reports" else f"{folder}/{item.path.stem}"))


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2004)


@pytest.fixture(params=PATCHES)
def patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


@pytest.fixture(params=[name for name in PATCHES if name != "plate"])
def curved_patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]
