"""The files of the entries, taken in for the tests that ask for them."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from types import ModuleType

import pytest

from contact.catalogue import ALGORITHMS
from studies.scenes import plugins
from support.kinds import FILES


@pytest.fixture(scope="module")
def modules() -> Iterator[Mapping[str, ModuleType]]:
    """The files by the open door; catalogues, modules and the search path are put back for all other tests."""
    before, path = dict(ALGORITHMS), [*sys.path]
    for file in FILES.values():
        plugins.load_file(file)
    yield {name: sys.modules[name] for name in FILES}
    ALGORITHMS.clear()
    ALGORITHMS.update(before)
    sys.path[:] = path
    for name in FILES:
        del sys.modules[name]
