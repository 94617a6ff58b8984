"""Stores of another machine, solved once for all tests of a process."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from support.stores.elsewhere import BEAMS, TYRES, Elsewhere, solved


@pytest.fixture(scope="session")
def beams(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six cells that take no time."""
    return solved(tmp_path_factory.mktemp("beams"), "beams", BEAMS)


@pytest.fixture(scope="session")
def tyres(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tyre with stages, a curve by arc length, and a cell that fails."""
    return solved(tmp_path_factory.mktemp("tyres"), "tyres", TYRES)


@pytest.fixture
def elsewhere(beams: Path, tmp_path: Path) -> Elsewhere:
    """A copy of the beams."""
    return Elsewhere(Path(shutil.copytree(beams, tmp_path / "elsewhere")))


@pytest.fixture
def tyres_elsewhere(tyres: Path, tmp_path: Path) -> Elsewhere:
    """A copy of the tyres."""
    return Elsewhere(Path(shutil.copytree(tyres, tmp_path / "elsewhere")))
