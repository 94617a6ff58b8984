"""Parts written outside: a measure, an algorithm with two parameters and a scene, by ``--use`` and by entry points."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from studies.ask.request import UsageError
from studies.cli import main
from studies.experiments.extremes import CHARTS
from studies.fuzz.examine import command_of
from studies.run.campaign import find
from studies.run.plan import plan
from studies.scenes import SCENES
from studies.scenes.complete import Cell, complete
from studies.scenes.plugins import _check
from studies.solving.solve import solve
from studies.solving.trials import Question

ROOT = Path(__file__).parents[2]
PLUGIN = ROOT / "tests" / "plugin"
USE = ["--use", str(PLUGIN / "stranger.py")]
CAMPAIGN = """
[[cross]]
name = "ours"
measures = ["exact", "no-drilling"]
contacts = ["semismooth", "stiffening"]
[cross.scenes.pressed-arch]
meshes = ["1x8", "1x16", "1x32"]
"""


def footprint(*words: object, path: Path | None = None) -> tuple[int, str, str]:
    """Exit code, output and errors of the command line, with one more place to find packages in."""
    places = [*([str(path)] if path else []), str(ROOT)]
    done = subprocess.run(
        [sys.executable, "-m", "studies.cli", *map(str, words)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(places)},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def refused(put_back: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """The one line of ``footprint list``."""

    def line(*words: object, path: Path | None = None) -> str:
        if path is not None:
            monkeypatch.syspath_prepend(path)
        assert main(["list", *map(str, words)]) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        return said.removeprefix("footprint: plug-in ").rstrip()

    return line


def installed(folder: Path, source: str, entries: dict[str, dict[str, str]]) -> Path:
    """A folder that looks as if pip had installed the plug-in into it."""
    (folder / "stranger.py").write_text(source, encoding="utf-8")
    info = folder / "stranger-0.1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: stranger\nVersion: 0.1\n")
    lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in names.items()) for group, names in entries.items()]
    (info / "entry_points.txt").write_text("\n".join(lines))
    return folder


@pytest.fixture(scope="module")
def source() -> str:
    return (PLUGIN / "stranger.py").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def entries() -> dict[str, dict[str, str]]:
    project = tomllib.loads((PLUGIN / "pyproject.toml").read_text())["project"]
    return dict(project["entry-points"])


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory, source: str, entries: dict[str, dict[str, str]]) -> Path:
    return installed(tmp_path_factory.mktemp("site"), source, entries)


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("campaign") / "ours.toml"
    path.write_text(CAMPAIGN)
    return path


@pytest.fixture(scope="module")
def store(campaign: Path) -> Path:
    """The campaign solved by worker processes, with the plug-in as a file."""
    store = campaign.parent / "store"
    code, said, errors = footprint("run", campaign, "--store", store, "--engine", "local:2", *USE)
    assert code == 0, errors
    assert said == "ours: 12 cells: 12 converged; 12 solved now\n"
    return store


def test_the_plugin_is_short() -> None:
    assert sum(len(path.read_text().splitlines()) for path in PLUGIN.iterdir() if path.is_file()) < 120


@pytest.mark.slow
def test_a_file_solves_with_parameters_of_its_own(tmp_path: Path) -> None:
    own = ["--measure", "no-drilling", "--contact", "stiffening", "--set", "first=50", "--set", "rounds=1"]
    code, _, errors = footprint("solve", "pressed-arch", *own, "--out", tmp_path, *USE)
    assert code == 0, errors
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["settings"].items() >= {"first": 50.0, "rounds": 1, "epsilon": "inf"}.items()
    assert result["class"] == "converged"
    code, _, errors = footprint("solve", "pressed-arch", *own, "--set", "rounds=9", "--out", tmp_path, *USE)
    assert code == 2
    assert errors == "footprint: rounds = '9' must be a whole number in [1, 6]\n"


@pytest.mark.usefixtures("put_back")
def test_list_and_show_take_it_in(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", *USE]) == 0
    said = capsys.readouterr().out
    for line in (
        "no-drilling           Green-Lagrange strain; neglects the squares of w",
        "stiffening            Springs of growing stiffness",
        "pressed-arch          Clamped arch pressed by a plane",
    ):
        assert " ".join(line.split()) in " ".join(said.split())
    assert main(["show", "stiffening", *USE]) == 0
    assert "times that it grows tenfold" in capsys.readouterr().out


@pytest.mark.usefixtures("put_back")
def test_a_printed_command_names_the_files_of_its_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file below where one is by its path from there, so that the line does not depend on the machine."""
    monkeypatch.chdir(tmp_path)
    cell = Cell("", "pressed-arch", {"contact": "stiffening", "mesh": "1x8"}, {"rounds": "2"})
    assert "--use" not in cell.command
    (tmp_path / "my parts").mkdir()
    shutil.copy(PLUGIN / "stranger.py", tmp_path / "my parts")
    use = "--use 'my parts/stranger.py'"
    assert main(["show", "pressed-arch", *shlex.split(use)]) == 0
    assert cell.command.endswith(f"--set rounds=2 {use} --out DIR")
    question = Question("pressed-arch", SCENES["pressed-arch"], {}, {"contact": "stiffening"}, 0.01)
    assert question.command("1x8", {}, {}).endswith(f"--contact stiffening {use} --out DIR")
    assert CHARTS[0].command(0, 1).endswith(f"--at 0.0165482,1e-06 {use}")
    assert command_of(3, "panel").endswith(f"--kind panel {use}")
    assert main(["advise", "pressed-arch", "--error", "1%", *shlex.split(use)]) == 2
    assert f"footprint choose pressed-arch --error 1% {use} --out DIR" in capsys.readouterr().err
    for words in (["solve"], ["sweep", "--over", "none=1:2:3"]):
        more = ["--set", "none=1"] if words == ["solve"] else []
        assert main([words[0], "pressed-arch", *words[1:], *more, *shlex.split(use), "--out", "out"]) == 2
        assert f"footprint show pressed-arch {use}" in capsys.readouterr().err
    words = shlex.split(cell.command)[1:-1]
    assert main([*words, "out", "--no-error"]) == 0


@pytest.mark.usefixtures("put_back")
def test_commands_of_a_campaign_name_the_modules_beside_it(tmp_path: Path) -> None:
    shutil.copy(PLUGIN / "stranger.py", tmp_path)
    path = tmp_path / "ours.toml"
    path.write_text(f'modules = ["stranger"]\n{CAMPAIGN}')
    rows = plan(find(str(path), trust=True))
    assert all(f" --use {tmp_path / 'stranger.py'} --out DIR" in row.as_json()["command"] for row in rows)


@pytest.mark.slow
def test_pages_and_advice_take_it_in(store: Path, tmp_path: Path) -> None:
    code, _, errors = footprint("analyse", "ours", "--store", store, *USE)
    assert code == 0, errors
    code, _, errors = footprint("report", "--store", store, "--out", tmp_path)
    assert code == 0, errors
    pages = "".join(path.read_text() for path in tmp_path.glob("*.md"))
    for name in ("pressed-arch", "stiffening", "no-drilling"):
        assert name in pages
    code, said, errors = footprint(
        "advise", "pressed-arch", "--error", "2%", "--store", store, "--campaign", "ours", *USE
    )
    assert code == 0, errors
    assert "1x" in said


@pytest.mark.slow
def test_entry_points_give_the_same_cells(site: Path, store: Path, campaign: Path, tmp_path: Path) -> None:
    """By its name and source a part is the same, however it came; a changed source is another one."""
    code, said, errors = footprint("run", campaign, "--store", store, "--engine", "local:1", path=site)
    assert code == 0, errors
    assert said == "ours: 12 cells: 12 converged; 0 solved now\n"
    code, _, errors = footprint("solve", "pressed-arch", "--contact", "stiffening", "--out", tmp_path, path=site)
    assert code == 0, errors


@pytest.mark.slow
def test_worker_processes_find_entry_points_and_a_new_source_is_solved_again(
    site: Path, source: str, entries: dict[str, dict[str, str]], tmp_path: Path
) -> None:
    changed = tmp_path / "site"
    changed.mkdir()
    installed(changed, source + "\nEDITED = True\n", entries)
    small = tmp_path / "small.toml"
    small.write_text(
        '[[cross]]\nmeasures = ["no-drilling"]\n[cross.scenes.cantilever]\nmeshes = ["2x1"]\n'
        '[[cross]]\ncontacts = ["stiffening"]\n[cross.scenes.panel]\nmeshes = ["4x4"]\n'
        '[[cross]]\n[cross.scenes.cantilever]\nmeshes = ["4x1"]\n'
    )
    for place, solved in ((site, 3), (site, 0), (changed, 2)):
        code, said, errors = footprint("run", small, "--store", tmp_path / "store", "--engine", "local:1", path=place)
        assert code == 0, errors
        assert said == f"small: 3 cells: 3 converged; {solved} solved now\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("import nothing_of_this_name", "ModuleNotFoundError: No module named 'nothing_of_this_name'"),
        ("def", "SyntaxError: invalid syntax"),
        ("raise SystemExit(0)", "SystemExit: 0"),
        (None, "no such file"),
    ],
)
def test_a_broken_file_is_one_line(text: str | None, says: str, tmp_path: Path, refused: Callable[..., str]) -> None:
    path = tmp_path / "broken.py"
    if text is not None:
        path.write_text(text)
    assert refused("--use", path).startswith(f"{path}: {says}")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            "from formulations.strains.measure import RigidBodyLaw as Law\nLaw(twist=abs)",
            "RigidBodyLaw.__init__() got an unexpected keyword argument 'twist'; "
            "there are translation, out_of_plane, drilling, axis",
        ),
        (
            "from formulations.strains.measure import quadratic_measure\nquadratic_measure('a', {}, source='b')",
            "quadratic_measure() got an unexpected keyword argument 'source'; "
            "there are name, terms, reference, rigid_body_law, kinematics, meaning",
        ),
        (
            "import formulations.strains.measure as of\nof.quadratic_measure('a', {}, source='b')",
            "quadratic_measure() got an unexpected keyword argument 'source'; "
            "there are name, terms, reference, rigid_body_law, kinematics, meaning",
        ),
        ("def product(a): return a\nproduct(b=1)", "product() got an unexpected keyword argument 'b'"),
        ("from numpy import arange\narange(3, size=4)", "arange() got an unexpected keyword argument 'size'"),
        ("import shlex\nshlex.quote(word='a')", "quote() got an unexpected keyword argument 'word'"),
    ],
)
def test_an_unknown_argument_is_answered_with_those_there_are(
    text: str, says: str, tmp_path: Path, refused: Callable[..., str]
) -> None:
    path = tmp_path / "broken.py"
    path.write_text(text)
    assert refused("--use", path) == f"{path}: TypeError: {says}"


INCOMPLETE = {
    "footprint.contact": ("from contact.catalogue import ALGORITHMS as parts", "parameters, supports, solve"),
    "footprint.scenes": ("from studies.scenes import SCENES as parts", "title, settings, references, build"),
    "footprint.measures": ("from formulations.strains.catalogue import MEASURES as parts", "strain, gradient"),
}
HALF = """
class Half:
    name = "half"
    reference = rigid_body_law = kinematics = contract = default_mesh = epsilon = None
"""


@pytest.mark.parametrize("group", INCOMPLETE)
def test_an_incomplete_part_is_one_line(group: str, tmp_path: Path, refused: Callable[..., str]) -> None:
    catalogue, missing = INCOMPLETE[group]
    path = tmp_path / "half.py"
    path.write_text(f"{catalogue}\n{HALF}\nparts['half'] = Half\n")
    assert refused("--use", path) == f"{path}: 'half' of {group}: the part has no {missing}"


OF_MEASURES = "from formulations.strains.catalogue import MEASURES\n"
OF_SCENES = """from studies.scenes import SCENES
class Whole:
    name, title, default_mesh, settings, references, build = 'whole', '', {mesh}, (), (), None
SCENES['whole'] = Whole{call}
"""
MISTAKEN = {
    "taken": (
        f"{OF_MEASURES}MEASURES['exact'] = MEASURES['linear']",
        "'exact' of footprint.measures: the name is taken by another part",
    ),
    "another name": (
        f"{OF_MEASURES}MEASURES['mine'] = MEASURES['linear']",
        "'mine' of footprint.measures: the name of the part is 'linear'",
    ),
    "a class": (
        OF_SCENES.format(mesh=(1, 1), call=""),
        "'whole' of footprint.scenes: the part has to be an instance, not a class",
    ),
    "half a mesh": (
        OF_SCENES.format(mesh=8, call="()"),
        "'whole' of footprint.scenes: default_mesh has to be two whole numbers from 1, not 8",
    ),
}


@pytest.mark.parametrize("what", MISTAKEN)
def test_a_part_that_cannot_be_taken_is_one_line_and_leaves_all_as_it_was(
    what: str, tmp_path: Path, refused: Callable[..., str]
) -> None:
    """Nothing of ours is replaced; the same file is refused again."""
    before = MEASURES["exact"], set(MEASURES), set(SCENES)
    path = tmp_path / "mistaken.py"
    source, says = MISTAKEN[what]
    path.write_text(source)
    for _ in range(2):
        assert refused("--use", path).startswith(f"{path}: {says}")
        assert (MEASURES["exact"], set(MEASURES), set(SCENES)) == before


OWN_RANGE = 'Parameter("damping", "share of a step", low=0.1, high=1.0)'
OUT_OF_RANGE = {
    "algorithm": (
        f"""from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.parameters import SHARED, Parameter
class Damped(Semismooth):
    name = "damped"
    parameters = (*SHARED, {OWN_RANGE})
    damping: float = 2.0
ALGORITHMS["damped"] = Damped
""",
        "'damped' of footprint.contact: default damping = 2.0 must be a number in [0.1, 1]",
    ),
    "scene": (
        f"""from studies.ask.scene import Setting
{OF_SCENES.format(mesh=(1, 1), call="()").replace("settings, ", "").replace("(), (), None", "(), None")}
Whole.settings = (Setting.positive("h_mm", -1.0, "thickness", 20),)
""",
        "'whole' of footprint.scenes: default h_mm = -1.0 must be a number in (0, 20]",
    ),
}


@pytest.mark.parametrize("part", OUT_OF_RANGE)
def test_a_default_out_of_its_own_range_is_one_line(part: str, tmp_path: Path, refused: Callable[..., str]) -> None:
    source, says = OUT_OF_RANGE[part]
    path = tmp_path / "mistaken.py"
    path.write_text(source)
    assert refused("--use", path) == f"{path}: {says}"


def test_the_defaults_of_all_parts_are_in_their_own_ranges() -> None:
    for name, algorithm in ALGORITHMS.items():
        _check(name, "footprint.contact", algorithm)
    for name, scene in SCENES.items():
        _check(name, "footprint.scenes", scene)


@pytest.mark.parametrize(
    ("field", "says"), [("", "no default for rounds"), ("    rounds: int = 2", "to be a class, not an instance")]
)
def test_an_algorithm_that_is_not_configured_by_its_fields_is_one_line(
    field: str, says: str, tmp_path: Path, refused: Callable[..., str]
) -> None:
    source = f"""from contact.algorithms.semismooth import Semismooth
from contact.parameters import Parameter
class Rounds(Semismooth):
    name = "rounds"
    parameters = (Parameter("rounds", "how often"),)
{field}
PART = Rounds{"()" if field else ""}
"""
    site = installed(tmp_path, source, {"footprint.contact": {"rounds": "stranger:PART"}})
    assert refused(path=site) == f"'rounds' of footprint.contact (stranger:PART): the part has {says}"


def test_a_file_with_the_name_of_another_module_is_one_line(tmp_path: Path, refused: Callable[..., str]) -> None:
    path = tmp_path / "json.py"
    path.write_text("")
    assert refused("--use", path).startswith(f"{path}: the name 'json' is taken by ")


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ({"footprint.scenes": {"pressed-arch": "stranger:NOTHING"}}, "has no attribute 'NOTHING'"),
        ({"footprint.measures": {"exact": "stranger:NO_DRILLING"}}, "the name of the part is 'no-drilling'"),
        ({"footprint.contact": {"semismooth": "stranger:Stiffening"}}, "the name of the part is 'stiffening'"),
    ],
)
def test_a_broken_entry_point_is_one_line(
    entry: dict[str, dict[str, str]], says: str, source: str, tmp_path: Path, refused: Callable[..., str]
) -> None:
    ((group, names),) = entry.items()
    said = refused(path=installed(tmp_path, source, entry))
    assert said.startswith(f"{next(iter(names))!r} of {group} (")
    assert says in said


FOAM = '''
"""Blatz and Ko's foam, W = mu/2 (tr C^-1 + 2 J - 5), which is that of nu = 1/4."""
from dataclasses import dataclass

import numpy as np

from formulations.section.laws import LAWS
from formulations.section.material import lame_constants
from formulations.section.material import Principal


@dataclass(frozen=True)
class BlatzKo(Principal):
    mu: float

    @classmethod
    def of(cls, ply):
        return cls(lame_constants(ply)[1])

    def stored(self, h):
        return self.mu / 2 * (np.exp(-2 * h).sum(axis=-1) + 2 * np.exp(h.sum(axis=-1)) - 5)

    def kirchhoff(self, h):
        e, J = np.exp(-2 * h), np.exp(h.sum(axis=-1))[..., None]
        return self.mu * (J - e), self.mu * (J[..., None] + 2 * e[..., None] * np.eye(3))


LAWS["foam"] = BlatzKo.of
'''


def test_a_law_from_a_file_is_solved_and_judged(tmp_path: Path) -> None:
    """Its small strains are those of the ply: at a thousandth of the stretch the pressure is that of any law."""
    (tmp_path / "foam.py").write_text(FOAM, encoding="utf-8")
    small = {"nu": "0.25", "load_fraction": "0.001"}
    settings = [word for key, value in small.items() for word in ("--set", f"{key}={value}")]
    words = ("solve", "rubber-tube", "--mesh", "1x1", "--no-error", *settings, "--set", "law=foam")
    code, _, error = footprint(*words, "--use", tmp_path / "foam.py", "--out", tmp_path / "foam")
    assert code == 0, error
    record = json.loads((tmp_path / "foam" / "result.json").read_text())["quantities"]["pressure_MPa"]
    ours = solve(*complete("rubber-tube", {**small, "law": "neo-hooke"}, "1x1")).quantities["pressure_MPa"]
    assert record == pytest.approx(ours, rel=5e-3)
    with pytest.raises(UsageError, match="law = 'foam' must be one of svk, hencky, neo-hooke, mooney-rivlin, ogden"):
        complete("rubber-tube", {"law": "foam"})
