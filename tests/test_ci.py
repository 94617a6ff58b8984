"""What the project declares is what the workflows try, and what recipes and archives say of it."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_oldest_versions_are_tested() -> None:
    bounds = dict(text.split(">=") for text in PROJECT["dependencies"])
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    job = re.split(r"^  \w+:", workflow.partition("\n  oldest:")[2], maxsplit=1, flags=re.MULTILINE)[0]
    pinned = dict(re.findall(r'"([\w-]+)==([\d.]+)\.\*"', job))
    assert pinned.keys() == bounds.keys()
    for name, bound in bounds.items():  # 14 and 14.0.* are one
        assert pinned[name].split(".")[: bound.count(".") + 1] == bound.split("."), name


def test_the_recipe_of_conda_asks_for_the_same() -> None:
    recipe = yaml.safe_load((ROOT / ".github/conda/recipe.yaml").read_text(encoding="utf-8"))
    here = [*PROJECT["dependencies"], f"python{PROJECT['requires-python']}"]
    there = [text.replace("matplotlib-base", "matplotlib").replace(" ", "") for text in recipe["requirements"]["run"]]
    assert sorted(there) == sorted(here)
    assert recipe["package"]["name"] == PROJECT["name"]
    assert recipe["about"]["summary"] == PROJECT["description"]
    (script,) = recipe["build"]["python"]["entry_points"]
    assert script == " = ".join(("footprint", PROJECT["scripts"]["footprint"]))


def test_archives_and_citations_say_the_same() -> None:
    archive = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    citation = yaml.safe_load((ROOT / ".github/CITATION.cff").read_text(encoding="utf-8"))
    assert archive["title"] == citation["title"]
    assert archive["keywords"] == PROJECT["keywords"]
    assert archive["license"] == citation["license"] == PROJECT["license"]
    names = [each["name"] for each in PROJECT["authors"]]
    assert [each["name"] for each in archive["creators"]] == [each["name"] for each in citation["authors"]] == names


def test_only_a_tag_publishes_and_only_what_was_tried() -> None:
    workflow = yaml.safe_load((ROOT / ".github/workflows/release.yml").read_text(encoding="utf-8"))
    assert workflow[True] == {"push": {"tags": ["v*"]}}  # YAML reads `on` as true
    jobs = workflow["jobs"]
    assert [jobs[name].get("needs") for name in ("build", "try", "publish", "site")] == [
        None,
        "build",
        "try",
        "publish",
    ]
    asked = {name: set(job.get("permissions", {})) for name, job in jobs.items()}
    assert asked == {"build": set(), "try": set(), "publish": {"contents", "id-token"}, "site": {"pages", "id-token"}}
    for place in ("ci.yml", "release.yml"):
        text = (ROOT / ".github/workflows" / place).read_text(encoding="utf-8")
        made = set(re.findall(r"make (\w+)", text))
        assert made <= set(re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
