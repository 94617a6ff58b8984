"""The examples of README and manual run, stay short, and do what they say."""

from __future__ import annotations

import math
import re
import sys
import types
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad_vec

import studies.footprint
from contact.balances import BALANCE
from contact.catalogue import ALGORITHMS
from contact.verify import EQUILIBRIUM, GAP, PAIR, POSITION, SLIGHT
from formulations.conditions.boundary import EDGES
from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import N_Q, QUANTITIES, STRAINS
from reports.chapter import listed
from reports.contents import CHAPTERS
from studies.cli import _parser
from studies.experiments.conformance import conformance
from studies.run.campaign import names as campaigns
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.contact.base import ContactModel, Touch
from studies.solving.result import SOLVED
from studies.solving.solve import solve
from support.sources import MANUAL, PAGES, README, ROOT, blocks, commands, file_of

PAGES_WITH_LINKS = [*PAGES, *sorted((ROOT / ".github").glob("*.md"))]


def test_the_readme_is_short_and_lists_the_pages() -> None:
    text = README.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 120
    published = [each for each in CHAPTERS if (ROOT / "reports/pages" / each.file).exists()]
    assert listed(published, "reports/pages/") in text


@pytest.mark.parametrize("page", PAGES_WITH_LINKS, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if "://" not in link and not (page.parent / link).exists()] == []


def test_the_bounds_of_the_judge_are_those_of_the_theory() -> None:
    text = (MANUAL / "theory.md").read_text(encoding="utf-8").partition("### The judge")[2].partition("\n### ")[0]
    for bound in (EQUILIBRIUM, BALANCE, SLIGHT, GAP, POSITION, PAIR):
        assert f"{bound:.2g}".replace("e-0", "e-") in text


def test_the_page_of_scenes_has_every_edge_and_all_that_a_scene_with_contact_gives_and_reads() -> None:
    text = (MANUAL / "scene.md").read_text(encoding="utf-8")
    of_model = {field.name: field.default for field in fields(ContactModel)}
    for word in (*EDGES, *of_model, *(field.name for field in fields(Touch))):
        assert f"`{word}`" in text, word
    for name in ("key", "body_at", "lying", "face"):
        (line,) = (each for each in text.splitlines() if each.startswith(f"| `{name}` |"))
        assert f"| `{of_model[name]!r}` |".replace("'", '"') in line


@pytest.mark.slow
def test_the_notebook_of_the_readme(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    (code,) = (each.text for each in blocks(README) if each.language == "python")
    names: dict = {}
    monkeypatch.setitem(sys.modules, "footprint", studies.footprint)  # as the build lays it down
    exec(code, names)
    run = names["run"]
    assert list(run.steps["delta_mm"]) == [5.0, 10.0]
    assert run.outcome == "converged"
    assert f"{run.steps['force_N'].iloc[-1]:.2f}"[:5] in capsys.readouterr().out
    assert run.certificate["equilibrium"].max() < 1e-8
    kept = solve(*complete("tyre", {"delta_mm": "5,10"}, "42x40"))
    assert list(run.steps["force_N"]) == pytest.approx([step["force_N"] for step in kept.steps], rel=1e-9)
    assert run.errors["force_N"]["low"] < run.steps["force_N"].iloc[-1] < run.errors["force_N"]["high"]


ADDED = re.compile(r'^add_tables\("(\w+)"', re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_printed_command_is_one(page: Path) -> None:
    """Its options are known, and the campaign of who reads its cells is one of ours, a file, or of a printed file."""
    printed = [name for each in blocks(page) if each.title for name in ADDED.findall(each.text)]
    for words in (words for words in commands(page) if words != ["--version"]):
        options = _parser(words).parse_args(words)  # exits where a word is not known
        if words[0] in ("run", "time"):
            assert options.campaign in ("fuzz", *campaigns(), *printed) or options.campaign.endswith(".toml"), words


def test_the_commands_are_seen() -> None:
    assert sum(len(commands(page)) for page in PAGES) > 60


@pytest.fixture
def tutorial(monkeypatch: pytest.MonkeyPatch) -> str:
    """The measure of the manual, executed on a copy of the catalogue; returns its code."""
    code = file_of("measure", "no_drilling.py")
    for name, measure in dict(MEASURES).items():
        monkeypatch.setitem(MEASURES, name, measure)
    monkeypatch.setitem(MEASURES, "no-drilling", None)
    exec(code, {})
    return code


def test_a_measure_takes_under_twenty_lines(tutorial: str) -> None:
    assert len([line for line in tutorial.splitlines() if line.strip()]) < 20


def test_the_new_measure_leaves_its_declared_strain(tutorial: str) -> None:
    theta = 0.7
    q = np.zeros(N_Q)
    for face in "-+":  # a rotation about the normal: l = c - 1, w1 = s, w2 = -s
        for name, value in (("l1", math.cos(theta) - 1), ("l2", math.cos(theta) - 1)):
            q[QUANTITIES.index(name + face)] = value
        q[QUANTITIES.index("w1" + face)] = math.sin(theta)
        q[QUANTITIES.index("w2" + face)] = -math.sin(theta)
    strain = MEASURES["no-drilling"].strain(q)
    declared = MEASURES["no-drilling"].rigid_body_law.drilling(theta, 1.0)
    assert strain[STRAINS.index("E11-")] == pytest.approx(declared, abs=1e-14)
    assert declared < -0.2


def test_the_new_measure_conforms(tutorial: str) -> None:
    assert not [check for check in conformance(MEASURES["no-drilling"]) if not check.passed]


def test_the_new_measure_solves_a_scene(tutorial: str) -> None:
    solution = solve(*complete("tyre", {"delta_mm": "5"}, "12x12", measure="no-drilling"))
    assert solution.outcome.converged


# --- the scene ----------------------------------------------------------------------------------------------------

MESH = 2e-3  # what the manual says of 64 elements
EXTRAPOLATED = 1e-4  # of two meshes


@pytest.fixture
def scene(monkeypatch: pytest.MonkeyPatch) -> dict:
    """Names of the manual's scene, executed on a copy of the catalogue."""
    code = file_of("scene", "arch.py")
    assert len([line for line in code.splitlines() if line.strip()]) < 40
    monkeypatch.setitem(SCENES, "arch", None)
    names: dict = {"__name__": "arch"}
    monkeypatch.setitem(sys.modules, "arch", types.ModuleType("arch"))  # dataclasses look their module up
    exec(code, names)
    return names


def sags(mesh: str, measure: str, fractions: str = "0.01,1", **settings: str) -> list[float]:
    solution = solve(*complete("arch", {"load_fraction": fractions, **settings}, mesh, measure=measure))
    assert solution.outcome.converged
    return [step["sag_mm"] for step in solution.steps]


def curved_beam(scene: dict) -> float:
    """Sag of the crown by Castigliano: couple M0 and thrust H0 at the crown do no work, nu = 0.

    With the angle t from the crown M = M0 - H0 R (1 - cos t) + (P/2) R sin t, N = H0 cos t + (P/2) sin t,
    V = H0 sin t - (P/2) cos t; U = int (M^2/EI + N^2/EA + V^2/GA) R dt/2 of each half.
    """
    E, R, b, h, P = (scene[name] for name in ("E", "R", "WIDTH", "H", "P"))
    compliance = np.diag([12 / (E * b * h**3), 1 / (E * b * h), 2 / (E * b * h)])

    def work(t: float) -> np.ndarray:
        c, s = math.cos(t), math.sin(t)
        rows = np.array([[1, -R * (1 - c), R * s / 2], [0, c, s / 2], [0, s, -c / 2]])  # of M0, H0, P
        return R * rows.T @ compliance @ rows

    F, _ = quad_vec(work, 0, scene["ANGLE"])
    free = np.linalg.solve(F[:2, :2], -F[:2, 2])
    return 2 * P * (F[2, 2] + F[2, :2] @ free)


def test_the_new_scene_meets_the_curved_beam(scene: dict) -> None:
    exact = curved_beam(scene)
    (reference,) = SCENES["arch"].references
    assert reference.value == pytest.approx(exact, rel=1e-5)
    coarse, fine = (sags(mesh, "linear")[1] for mesh in ("1x32", "1x64"))
    assert fine == pytest.approx(exact, rel=MESH)
    assert fine + (fine - coarse) / 3 == pytest.approx(exact, rel=EXTRAPOLATED)


def test_the_new_scene_is_linear_only_under_small_loads(scene: dict) -> None:
    """At a hundredth of the load it is the linear one, at all of it a third more; with either interpolation."""
    exact = curved_beam(scene)
    small, full = sags("1x64", "exact")
    assert small / 0.01 == pytest.approx(exact, rel=2 * MESH)
    assert full / exact == pytest.approx(1.33, abs=0.01)
    assert sags("1x64", "exact", "1", interpolation="isoparametric")[0] == pytest.approx(full, rel=MESH)


def test_the_new_scene_takes_the_measure_of_the_manual(tutorial: str, scene: dict) -> None:
    """Without drilling in it the arch is the same: a strip does not drill."""
    assert sags("1x32", "no-drilling", "1") == pytest.approx(sags("1x32", "exact", "1"), rel=1e-6)


@pytest.fixture
def saddle(monkeypatch: pytest.MonkeyPatch) -> str:
    """The algorithm of the manual, in the catalogue; returns its code."""
    code = file_of("algorithm", "saddle.py")
    monkeypatch.setitem(ALGORITHMS, "saddle", None)
    exec(code, {"__name__": __name__})  # its dataclass asks for its module
    return code


@pytest.mark.parametrize(
    ("scene", "given", "mesh"),
    [
        ("panel", {"foundation": "ball"}, "8x8"),  # curved: the curvature of the gap is in the tangent
        ("ring", {}, "1x16"),
        ("tyre", {"delta_mm": "5"}, "8x8"),  # inflated before: no candidate
        ("cantilever", {}, "4x1"),
    ],
)
def test_the_new_algorithm_ends_where_ours_do(saddle: str, scene: str, given: dict[str, str], mesh: str) -> None:
    actual, ours = (solve(*complete(scene, given, mesh, contact=contact)) for contact in ("saddle", "semismooth"))
    assert actual.verdict == ours.verdict
    assert actual.verdict in SOLVED
    assert len(actual.steps) == len(ours.steps) > 0
    for name, value in ours.quantities.items():
        assert actual.quantities[name] == pytest.approx(value, rel=1e-7), name
    assert actual.steps[-1].get("contact_nodes") == ours.steps[-1].get("contact_nodes")


def test_a_minimal_algorithm_stays_short(saddle: str) -> None:
    assert len(saddle.splitlines()) < 60
