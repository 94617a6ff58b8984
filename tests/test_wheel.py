"""Wheel and sdist: built from the tree, the wheel unpacked where nothing else of ours is, and used from there.

``DIST=dir`` tries those that were built before (``make dist``).
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from email import message_from_string
from pathlib import Path

import pytest

from studies import footprint as names
from studies.output import DISTRIBUTION

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PACKAGES = ("formulations", "contact", "studies", "reports")

pytestmark = pytest.mark.slow


LARGEST = 5e6  # bytes of each: nobody waits for it, and the index takes a hundred times as much


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of both, built by the backend that is installed: no network is asked."""
    if "DIST" in os.environ:
        return ROOT / os.environ["DIST"]
    pytest.importorskip("hatch_vcs", reason="the build backend is not installed (extra dev)")
    folder = tmp_path_factory.mktemp("dist")
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-d", str(folder)], cwd=ROOT, check=True)
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> Path:
    (actual,) = built.glob("*.whl")
    return actual


@pytest.fixture(scope="module")
def version(wheel: Path) -> str:
    return wheel.name.split("-")[1]


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
    """Campaigns, references, baseline and assets are read by the program; of the tree it has nothing else."""
    with zipfile.ZipFile(wheel) as archive:
        shipped = {name for name in archive.namelist() if ".dist-info/" not in name}
    done = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", *PACKAGES],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    ours = {name for name in done.stdout.splitlines() if not name.startswith("reports/pages/")}
    assert shipped - ours == {"footprint/__init__.py", "footprint/py.typed"}
    assert ours - shipped == set()


def test_both_are_small(built: Path) -> None:
    sizes = {path.name: path.stat().st_size for path in built.iterdir()}
    assert {name: size for name, size in sizes.items() if size > LARGEST} == {}
    assert len(sizes) == 2


def test_a_wheel_from_the_sdist_is_the_same(built: Path, wheel: Path, tmp_path: Path) -> None:
    """Without git: the version is that of the sdist."""
    (sdist,) = built.glob("*.tar.gz")
    pip("wheel", "--no-deps", "--no-index", "--no-build-isolation", "--wheel-dir", str(tmp_path), str(sdist))
    (again,) = tmp_path.glob("*.whl")
    assert again.name == wheel.name
    with zipfile.ZipFile(wheel) as one, zipfile.ZipFile(again) as other:
        crcs = [{each.filename: each.CRC for each in archive.infolist()} for archive in (one, other)]
    assert crcs[0] == crcs[1]


def test_its_metadata_are_complete(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith(".dist-info/METADATA"))
        stated = message_from_string(archive.read(name).decode("utf-8"))
    assert stated["Name"] == PROJECT["name"] == DISTRIBUTION
    assert stated["Requires-Python"] == PROJECT["requires-python"]
    assert stated["License-Expression"] == "MIT"
    assert set(stated.get_all("Provides-Extra")) == set(PROJECT["optional-dependencies"])
    assert all(stated[each] for each in ("Version", "Summary", "Author", "Keywords", "Description-Content-Type"))


def test_sources_without_git_have_a_version(tmp_path: Path) -> None:
    """As an archive of a commit has them."""
    done = subprocess.run(
        ["git", "ls-files", "contact", "pyproject.toml", "README.md", "LICENSE", "formulations"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in done.stdout.splitlines():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    said = subprocess.run(
        [sys.executable, "-m", "hatchling", "version"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert re.fullmatch(r"\d+\.\d+\.\d+", said.stdout.strip())


def test_one_name_for_users(site: Path) -> None:
    """``import footprint`` loads nothing that computes, and solves."""
    code = """import sys, footprint
assert footprint.__file__.startswith(sys.argv[1])
print([name for name in ("numpy", "scipy", "pandas") if name in sys.modules], len(dir(footprint)))
print(footprint.solve("cantilever", mesh="4x1").verdict, footprint.describe("exact").name)"""
    environment = {**os.environ, "PYTHONPATH": str(site)}
    words = [sys.executable, "-P", "-c", code, str(site)]
    done = subprocess.run(words, cwd=site.parent, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [f"[] {len(names.__all__)}", "converged exact"]


def test_it_says_its_version_and_lists_its_parts(site: Path, version: str) -> None:
    assert version in footprint(site, "--version")
    listed = footprint(site, "list")
    assert all(name in listed for name in ("tyre", "exact", "semismooth"))
    script = next((site / "bin").glob("footprint*"))
    assert "studies.cli" in script.read_text(encoding="utf-8")


def test_it_advises_without_a_store(site: Path) -> None:
    """Price, unknowns, command, runner-up and how sure it is, from the tables that are shipped."""
    said = footprint(site, "advise", "cantilever", "--error", "1%")
    for words in ("s of processor time", "unknowns", "footprint solve cantilever", "runner-up:", "how sure: on"):
        assert words in said


def test_it_solves_plans_and_checks_without_the_tree(site: Path, version: str, tmp_path: Path) -> None:
    footprint(site, "solve", "cantilever", "--mesh", "4x1", "--out", str(tmp_path / "out"))
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["outcome"] == "converged"
    assert result["provenance"]["version"] == version
    campaign = tmp_path / "one.toml"
    campaign.write_text('[[cross]]\nmeshes = ["2x1"]\n[cross.scenes.cantilever]\n')
    footprint(site, "run", str(campaign), "--store", str(tmp_path / "store"))
    assert len(list((tmp_path / "store" / "cells").glob("*.json"))) == 1
    where = "import studies.gate.baseline as b, studies.scenes.data as d; print((b.HERE / b.TOLERANCES).exists(), "
    code = where + "len(d.read_reference('isotropic_tyre_3d_solid.csv')) > 0)"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["True", "True"]
