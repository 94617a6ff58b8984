"""Algorithms, measures and scenes from outside that lie, fall over or answer with what is not an answer."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from reports.contents import CHAPTERS
from studies.cli import main
from studies.run.lists import LISTS, MAKERS
from studies.scenes import SCENES as CATALOGUE

ALGORITHM = """import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.parameters import SHARED
from contact.problem import ContactSolution, Outcome


@dataclass(frozen=True)
class Odd:
    epsilon: float = math.inf
    solver: str = "auto"
    tolerance: float = 1e-9
    name: ClassVar[str] = "odd"
    parameters: ClassVar[tuple] = SHARED

    def supports(self, problem):
        return {supports}

    def solve(self, problem, start):
        n, m = len(start.u), len(problem.weights)
        found = Semismooth(self.epsilon).solve(problem, start)
        {solve}


ALGORITHMS["odd"] = Odd
"""
LINE = {
    word: number
    for number, text in enumerate(ALGORITHM.splitlines(), 1)
    for word in ("solve", "supports")
    if f"{{{word}}}" in text
}
SCENES = {"contact": ("panel", "4x4"), "none": ("cantilever", "4x1")}
NO_ANSWER = {
    "none": ("return None", "solve returned None, not a ContactSolution"),
    "a tuple": ("return found.u, found.pressure", "solve returned tuple, not a ContactSolution"),
    "a wrong shape": (
        "return replace(found, u=np.zeros(n + 1))",
        "solve returned u as float64 of shape ({more},), not as floats of shape ({n},)",
    ),
    "a list": ("return replace(found, u=found.u.tolist())", "solve returned u as list, not as floats of shape ({n},)"),
    "whole numbers": (
        "return replace(found, pressure=np.zeros(m, int))",
        "solve returned pressure as int64 of shape ({m},), not as floats of shape ({m},)",
    ),
    "a word": ("return replace(found, outcome='converged')", "solve returned outcome as str, not as an Outcome"),
    **{
        name: (
            f"return replace(found, counters={{'newton_iterations': {count}}})",
            "solve returned counters that are no finite numbers from 0 by name",
        )
        for name, count in {"a word for a counter": "'b'", "no number": "np.nan", "less than none": "-5"}.items()
    },
    "a list of rows": ("return replace(found, history=[])", "solve returned a history that is not a tuple of rows"),
    "a told event": (
        "return replace(found, history=({'event': 'gave up'},))",
        "solve returned a history with an event that is no Event",
    ),
    "an error": ("1 / 0", f"odd.py:{LINE['solve']}: ZeroDivisionError: division by zero"),
    "the end": ("raise SystemExit(0)", f"odd.py:{LINE['solve']}: SystemExit: 0"),
    "the end of support": ("1 / 0", f"odd.py:{LINE['supports']}: KeyError: 'no'"),
}


@pytest.fixture
def put_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Catalogues and modules as they were."""
    for catalogue, name in ((ALGORITHMS, "odd"), (MEASURES, "odd")):
        monkeypatch.delitem(catalogue, name, raising=False)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "odd", raising=False)
    sys.modules.pop("odd", None)


@pytest.fixture
def odd(put_back: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Exit code, output and errors of a solve by an algorithm with this last line."""

    def solved(solve: str, scene: str = "contact", supports: str = "None") -> tuple[int, str, str]:
        path = tmp_path / "odd.py"
        path.write_text(ALGORITHM.replace("{supports}", supports).replace("{solve}", solve))
        name, mesh = SCENES[scene]
        try:
            code = main(["solve", name, "--mesh", mesh, "--contact", "odd", "--use", str(path), "--out", str(tmp_path)])
        finally:
            ALGORITHMS.pop("odd", None)
            sys.modules.pop("odd", None)
        return code, *capsys.readouterr()

    return solved


@pytest.mark.parametrize(
    ("what", "scene"), [*((what, "contact") for what in NO_ANSWER), ("a wrong shape", "none"), ("an error", "none")]
)
def test_no_answer_is_one_line_that_names_the_algorithm(what: str, scene: str, odd, tmp_path: Path) -> None:
    solve, says = NO_ANSWER[what]
    n, m = {"contact": (54, 9), "none": (48, 0)}[scene]
    code, said, errors = odd(solve, scene, "{}['no']" if "support" in what else "None")
    wanted = says.replace("{n}", str(n)).replace("{more}", str(n + 1)).replace("{m}", str(m))
    assert (code, said) == (1, "")
    assert errors == f"footprint: contact algorithm 'odd': {wanted}\n"
    assert not (tmp_path / "result.json").exists()


LIES = {
    "rest": ("return replace(found, u=np.zeros(n), pressure=np.zeros(m), active=np.zeros(m, bool))", "{worst}"),
    "no number": ("return replace(found, u=np.full(n, np.nan))", "equilibrium is not a number"),
    "one that is not a number": ("found.u[-1] = np.nan; return found", "equilibrium is not a number"),
    "infinite": ("return replace(found, u=np.full(n, np.inf))", "equilibrium is not a number"),
    "so large that it overflows": ("return replace(found, u=np.full(n, 1e200))", "equilibrium is not a number"),
}


@pytest.mark.parametrize(
    ("lie", "scene"), [*((lie, "contact") for lie in LIES), ("rest", "none"), ("no number", "none")]
)
def test_a_lie_is_judged_wrong_and_never_stable(lie: str, scene: str, odd, tmp_path: Path) -> None:
    solve, worst = LIES[lie]
    code, said, errors = odd(solve, scene)
    assert code == 1
    assert "wrong: " in said
    assert errors.startswith("footprint: judged wrong: ")
    assert errors.count("\n") == 1
    assert (
        worst.replace("{worst}", {"contact": "penetration 1 mm above", "none": "equilibrium 1 above"}[scene]) in errors
    )
    record = json.loads((tmp_path / "result.json").read_text())
    assert (record["outcome"], record["class"]) == ("wrong", "wrong")
    assert record["steps"][-1]["stability"]["word"] == "not counted"


@pytest.mark.parametrize(
    ("nodes", "says"),
    [
        ("np.zeros(m, bool)", "set: 2 nodes that press are left out of the contact set, 0 open ones are in it"),
        ("np.ones(m, bool)", "set: 0 nodes that press are left out of the contact set, 7 open ones are in it"),
    ],
)
def test_a_set_that_is_not_that_of_the_nodes_that_press_is_wrong(nodes: str, says: str, odd) -> None:
    """The patch is read off it, and a right u and p are no excuse."""
    code, said, errors = odd(f"return replace(found, active={nodes})")
    assert code == 1
    assert errors == f"footprint: judged wrong: {says} at load_fraction 1\n"
    assert "wrong: " in said
    assert "no contact" not in said


@pytest.mark.parametrize("scene", SCENES)
def test_an_answer_without_counters_and_history_is_one(scene: str, odd, tmp_path: Path) -> None:
    code, _, errors = odd("return ContactSolution(found.u, found.pressure, found.active, found.outcome)", scene)
    assert (code, errors) == (0, "")
    record = json.loads((tmp_path / "result.json").read_text())
    assert record["class"] == "converged"
    assert {record["counters"][name] for name in ("newton_iterations", "factorisations")} == {0}
    assert record["steps"][0]["newton_iterations"] == 0


@pytest.mark.parametrize("scene", SCENES)
def test_support_is_none_or_a_reason(scene: str, odd, tmp_path: Path) -> None:
    code, _, errors = odd("return found", scene, "True")
    assert code == 1
    assert errors == "footprint: contact algorithm 'odd': supports returned True, not None or a reason\n"


@pytest.mark.parametrize("name", ["../../evil", "two\\nlines", "<img src=x>", "a|b"])
def test_a_name_that_is_no_word_is_refused_in_a_line(name: str, put_back: None, tmp_path: Path, capsys) -> None:
    """It would be a path of the card, a row of a table, and HTML."""
    path = tmp_path / "odd.py"
    text = ALGORITHM.replace("{supports}", "None").replace("{solve}", "")
    path.write_text(text.replace('"odd"', f'"{name}"'))
    assert main(["card", str(path), "--out", str(tmp_path)]) == 2
    errors = capsys.readouterr().err
    assert errors.endswith("the name must be 1 to 80 letters, digits, spaces and any of _ . , + = -\n")
    assert errors.count("\n") == 1


def test_an_algorithm_that_cannot_be_made_is_refused_in_a_line(put_back: None, tmp_path: Path, capsys) -> None:
    path = tmp_path / "odd.py"
    path.write_text(
        ALGORITHM.replace("    def supports", "    def __post_init__(self):\n        1 / 0\n\n    def supports")
    )
    words = ["panel", "--contact", "odd", "--use", str(path), "--out", str(tmp_path)]
    path.write_text(path.read_text().replace("{supports}", "None").replace("{solve}", ""))
    assert main(["solve", *words]) == 2
    assert capsys.readouterr().err.endswith("with its defaults: ZeroDivisionError: division by zero\n")


@pytest.mark.parametrize("scene", SCENES)
def test_a_failure_that_says_nothing_ends_the_path(scene: str, odd, tmp_path: Path) -> None:
    code, _, errors = odd("return ContactSolution(start.u, start.pressure, start.active, Outcome.DIVERGED)", scene)
    assert code == 3
    assert "the residual is no longer finite" in errors


CAMPAIGN = """[[cross]]
contacts = ["semismooth", "odd"]
[cross.scenes.panel]
meshes = ["4x4"]
"""


@pytest.mark.parametrize(
    ("lie", "ended"), [pytest.param("rest", "wrong", marks=pytest.mark.slow), ("an error", "crash")]
)
def test_a_campaign_with_cells_that_fail_says_how_many(
    lie: str, ended: str, put_back: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A refused one, and a path that ends, are findings; these are not."""
    solve, _ = {**LIES, **NO_ANSWER}[lie]
    (tmp_path / "odd.py").write_text(ALGORITHM.replace("{supports}", "None").replace("{solve}", solve))
    (tmp_path / "small.toml").write_text(CAMPAIGN)
    try:
        words = [str(tmp_path / "small.toml"), "--store", str(tmp_path / "store"), "--use", str(tmp_path / "odd.py")]
        code = main(["run", *words])
    finally:
        ALGORITHMS.pop("odd", None)
        sys.modules.pop("odd", None)
    said = capsys.readouterr()
    assert code == 1
    assert f"1 converged, 1 {ended}" in said.out
    assert (
        said.err
        == f"footprint: failed: 1 {ended}; footprint table small --store {tmp_path / 'store'} names the cells\n"
    )


PAGE = """from reports.chapter import Chapter
from reports.contents import CHAPTERS
from reports.markdown import Part
from studies.experiments import tabulated
from studies.run.lists import add_tables


@tabulated
def odd_table():
    yield {"a": 1}
    yield {"a": {second}}


def page(store):
    return Part("# Odd" + store.table("odd_table").a.missing)


add_tables("oddities", "A table", odd_table)
CHAPTERS.append(Chapter("odd", "Odd", "Why?", page, ("odd_table",)))
CHAPTERS.append(Chapter("needy", "Needy", "What?", page, ("odd_table", "nothing")))
"""


@pytest.fixture
def of_page(
    put_back: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> Iterator[Callable[..., tuple[int, str, str]]]:
    """Exit code, output and errors of a command on two pages with this second value in their table."""
    before = list(CHAPTERS)

    def answered(command: str, second: str, text: str = PAGE) -> tuple[int, str, str]:
        (tmp_path / "odd.py").write_text(text.replace("{second}", second))
        code = main([*command.split(), "--store", str(tmp_path / "store"), "--use", str(tmp_path / "odd.py")])
        return code, *capsys.readouterr()

    yield answered
    CHAPTERS[:] = before
    for names in (LISTS, MAKERS):
        names.pop("oddities", None)
        names.pop("odd_table", None)
    sys.modules.pop("odd", None)


def test_a_table_that_cannot_be_made_says_why(of_page: Callable[..., tuple[int, str, str]]) -> None:
    reason = "ZeroDivisionError at odd.py:11: division by zero"
    assert of_page("run oddities", "1 / 0") == (
        1,
        "oddities: 0 of 1 tables; tables not made: table odd_table (crash)\n",
        f"footprint: table odd_table: {reason}\nfootprint: failed: 1 tables not made\n",
    )


def test_a_page_that_cannot_be_made_says_why(of_page: Callable[..., tuple[int, str, str]], tmp_path: Path) -> None:
    assert of_page("run oddities", "2")[:2] == (0, "oddities: 1 of 1 tables\n")
    code, _, errors = of_page(f"report --out {tmp_path / 'pages'}", "2")
    needy, odd = errors.splitlines()
    assert code == 2
    assert needy == f"footprint: needy.md is left out: {tmp_path / 'store'} has no table nothing"
    assert "campaign 'oddities' cannot be put on pages: odd.py:15: AttributeError: 'Series' object" in odd


@pytest.mark.slow
def test_a_picture_that_is_no_function_is_a_line(of_page: Callable[..., tuple[int, str, str]], tmp_path: Path) -> None:
    drawn = PAGE.replace("import Part", "import Part, picture")
    drawn = drawn.replace('Part("# Odd" + store.table("odd_table").a.missing)', 'picture("odd.svg", "Odd", "<svg/>")')
    assert of_page("run oddities", "2", drawn)[0] == 0
    code, _, errors = of_page(f"report --out {tmp_path / 'pages'}", "2", drawn)
    assert code == 2
    assert errors.endswith("odd.py:15: TypeError: picture odd.svg is of type str, not a function that returns an SVG\n")


MEASURE = """from formulations.strains.catalogue import MEASURES

exact = MEASURES["exact"]


class Odd:
    name = "odd"

    def __getattr__(self, key):
        return getattr(exact, key)

    def strain(self, *asked):
        {strain}


MEASURES["odd"] = Odd()
"""


@pytest.mark.parametrize(
    ("strain", "says"),
    [
        ("1 / 0", "measure 'odd': odd.py:13: ZeroDivisionError: division by zero"),
        ("return None", "measure 'odd': TypeError: "),
        ("return exact.strain(*asked)[..., :2]", "measure 'odd': IndexError: "),
    ],
)
def test_a_measure_that_breaks_is_one_line_that_names_it(
    strain: str, says: str, put_back: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "odd.py"
    path.write_text(MEASURE.replace("{strain}", strain))
    try:
        words = ["cantilever", "--mesh", "4x1", "--measure", "odd", "--use", str(path), "--out", str(tmp_path)]
        code = main(["solve", *words])
    finally:
        MEASURES.pop("odd", None)
        sys.modules.pop("odd", None)
    errors = capsys.readouterr().err
    assert code == 1
    assert errors.startswith(f"footprint: {says}")
    assert errors.count("\n") == 1


SCENE = """from studies.scenes import SCENES


class Odd:
    name = "odd"

    def __getattr__(self, key):
        return getattr(SCENES["cantilever"], key)

    def build(self, request):
        return 1 / 0


SCENES["odd"] = Odd()
"""


@pytest.mark.parametrize(
    "words",
    [
        ["solve", "--out", "{out}"],
        ["solve", "--no-error", "--out", "{out}"],
        ["solve", "--error", "5%", "--out", "{out}"],
        ["solve", "--error", "5%", "--mesh", "4x1", "--out", "{out}"],
        ["solve", "--memory-limit", "1000", "--out", "{out}"],
        ["choose", "--error", "5%", "--budget", "5s", "--out", "{out}"],
        ["export", "--format", "inp", "--out", "{out}.inp"],
    ],
    ids=" ".join,
)
def test_a_scene_that_cannot_be_built_is_one_line_that_names_it(
    words: list[str], put_back: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "odd.py", str(tmp_path / "out")
    path.write_text(SCENE)
    command, *options = (word.replace("{out}", out) for word in words)
    try:
        code = main([command, "odd", "--use", str(path), *options])
    finally:
        CATALOGUE.pop("odd", None)
        sys.modules.pop("odd", None)
    errors = capsys.readouterr().err
    assert code == 1
    assert errors == "footprint: scene 'odd': odd.py:11: ZeroDivisionError: division by zero\n"


PLANE = """from dataclasses import replace

import numpy as np

from contact.obstacles.foundation import RigidPlane
from studies.scenes import SCENES

UP = np.array([0.0, 0.0, 1.0])


class Odd:
    name = "odd"

    def __getattr__(self, key):
        return getattr(SCENES["strip-contact"], key)

    def build(self, request):
        plane = {plane}
        return replace(SCENES["strip-contact"].build(request), plane_at=lambda load: plane)


SCENES["odd"] = Odd()
"""
PLANES = {
    "(np.zeros(3), 1.5)": "ValueError: the normal of a plane must be a unit vector (3,), got [0. 0. 0.]",
    "(np.full(3, np.nan), 1.5)": "ValueError: the normal of a plane must be a unit vector (3,), got [nan nan nan]",
    "([1.0, 0.0], 1.5)": "ValueError: the normal of a plane must be a unit vector (3,), got [1.0, 0.0]",
    "(UP, np.nan)": "the position of the foundation at rest is not a number",
    "(-UP, -1.5)": "the whole wall at rest lies inside the foundation, 1 mm deep: the normal of a plane points from",
    "(UP, -50.0)": "the whole wall at rest lies inside the foundation, 50.5 mm deep: the normal of a plane points from",
}


@pytest.fixture
def of_plane(
    put_back: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> Iterator[Callable[[str], tuple[int, str]]]:
    """Exit code and errors of a strip that is blown against this plane."""

    def solved(plane: str) -> tuple[int, str]:
        path = tmp_path / "odd.py"
        path.write_text(PLANE.replace("{plane}", plane))
        code = main(["solve", "odd", "--mesh", "16x1", "--use", str(path), "--out", str(tmp_path / "out")])
        return code, capsys.readouterr().err

    yield solved
    CATALOGUE.pop("odd", None)
    sys.modules.pop("odd", None)


@pytest.mark.parametrize("plane", PLANES)
def test_a_plane_that_no_path_begins_before_is_one_line_at_once(plane: str, of_plane) -> None:
    code, errors = of_plane(f"RigidPlane{plane}")
    assert code in (1, 2)  # of what a part raises, and of a foundation that cannot be there
    assert PLANES[plane] in errors
    assert errors.count("\n") == 1


def test_the_normal_of_a_plane_may_be_a_list(of_plane) -> None:
    assert of_plane("RigidPlane([0, 0, 1], 1.5)") == (0, "")
