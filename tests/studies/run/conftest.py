"""The small campaign, solved once for all tests of a process."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from studies import scenes
from support.stores.campaigns import again


@pytest.fixture(autouse=True)
def scenes_of_a_test_end_with_it() -> Iterator[None]:
    """The catalogue as it was, whatever the modules of a campaign have put into it."""
    before = dict(scenes.SCENES)
    yield
    for name in scenes.SCENES.keys() - before.keys():
        del scenes.SCENES[name]
        sys.modules.pop("planted_cells", None)


@pytest.fixture(scope="session")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small campaign, solved one by one."""
    folder = tmp_path_factory.mktemp("solved")
    assert again(folder, folder / "store").classes == {"converged": 6}
    return folder / "store"


@pytest.fixture
def own(solved: Path, tmp_path: Path) -> Path:
    """A copy that a test may damage."""
    return Path(shutil.copytree(solved, tmp_path / "store"))
