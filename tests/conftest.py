"""Fixtures of all tests: a seeded generator and the patches."""

from __future__ import annotations

import numpy as np
import pytest

from support.problems.shells import PATCHES, Patch


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(2004)


@pytest.fixture(params=PATCHES)
def patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]


@pytest.fixture(params=[name for name in PATCHES if name != "plate"])
def curved_patch(request: pytest.FixtureRequest) -> Patch:
    return PATCHES[request.param]
