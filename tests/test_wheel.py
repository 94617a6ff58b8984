"""The wheel: built from the tree, unpacked where nothing else of ours is, and used from there."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PACKAGES = ("formulations", "contact", "studies", "reports")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built by the backend that is installed: no network is asked."""
    pytest.importorskip("hatchling", reason="the build backend is not installed (extra dev)")
    folder = tmp_path_factory.mktemp("dist")
    pip("wheel", "--no-deps", "--no-index", "--no-build-isolation", "--wheel-dir", str(folder), str(ROOT))
    (found,) = folder.glob("*.whl")
    return found


@pytest.fixture(scope="module")
def site(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    pip("install", "--no-deps", "--no-index", "--target", str(folder), str(wheel))
    return folder


def pip(*words: str) -> None:
    subprocess.run([sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", *words], check=True)


def footprint(site: Path, *words: str) -> str:
    """What the installed program prints, run where no source is; of ours only the wheel is on the path."""
    code = "import sys, studies.cli as c; assert c.__file__.startswith(sys.argv.pop(1)); sys.exit(c.main())"
    environment = {**os.environ, "PYTHONPATH": str(site)}
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, str(site), *words],
        cwd=site.parent,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_it_has_every_file_of_the_packages(wheel: Path) -> None:
    """Campaigns, references, baseline and assets are read by the program, and not one of them is a module."""
    with zipfile.ZipFile(wheel) as archive:
        shipped = set(archive.namelist())
    data = ("*.py", "*.toml", "*.csv", "*.json", "*.css", "*.js", "*.html", "*.md", "py.typed")
    ours = {
        path.relative_to(ROOT).as_posix() for name in PACKAGES for kind in data for path in (ROOT / name).rglob(kind)
    }
    assert ours - shipped == set()
    for place in (
        "studies/run/shipped/quick.toml",
        "studies/scenes/data/",
        "studies/baseline/",
        "reports/assets/",
        "reports/templates/",
        "studies/analysis/advice/",
    ):
        assert any(name.startswith(place) for name in shipped), place
    assert not [name for name in shipped if name.startswith("tests/")]


def test_it_says_its_version_and_lists_its_parts(site: Path) -> None:
    assert PROJECT["version"] in footprint(site, "--version")
    listed = footprint(site, "list")
    assert all(name in listed for name in ("tyre", "exact", "semismooth"))
    script = next((site / "bin").glob("footprint*"))
    assert "studies.cli" in script.read_text(encoding="utf-8")


def test_it_advises_without_a_store(site: Path) -> None:
    """Price, unknowns, command, runner-up and how sure it is, from the tables that are shipped."""
    said = footprint(site, "advise", "cantilever", "--error", "1%")
    for words in ("s of processor time", "unknowns", "footprint solve cantilever", "runner-up:", "how sure: on"):
        assert words in said


def test_it_solves_plans_and_checks_without_the_tree(site: Path, tmp_path: Path) -> None:
    footprint(site, "solve", "cantilever", "--mesh", "4x1", "--out", str(tmp_path / "out"))
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["outcome"] == "converged"
    assert result["provenance"]["version"] == PROJECT["version"]
    campaign = tmp_path / "one.toml"
    campaign.write_text('[[cross]]\nmeshes = ["2x1"]\n[cross.scenes.cantilever]\n')
    footprint(site, "run", str(campaign), "--store", str(tmp_path / "store"))
    assert len(list((tmp_path / "store" / "cells").glob("*.json"))) == 1
    where = "import studies.gate.baseline as b, studies.scenes.data as d; print((b.HERE / b.TOLERANCES).exists(), "
    code = where + "len(d.read_reference('isotropic_tyre_3d_solid.csv')) > 0)"
    told = subprocess.run(
        [sys.executable, "-P", "-c", code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout.split() == ["True", "True"]
