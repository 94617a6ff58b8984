"""Meshes of gmsh in both formats with the TOML beside them, against the same shell as a deck, and a closed form."""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from studies.cli import OK, WRONG_USE, main
from support.decks import answered, mesh_lines, numbers, plate

KINDS = {"point": 15, "line": 1, "triangle": 2, "quad": 3, "quad9": 10}
DIMENSIONS = {"point": 0, "line": 1, "triangle": 2, "quad": 2, "quad9": 2}
Groups = Sequence[tuple[str, str, Sequence[Sequence[int]]]]  # name, kind, nodes from 1 of each cell
BESIDE = """
read_off = ["tip"]
[materials]
steel = {E = 1000.0, nu = 0.0}
[sections]
skin = {thickness = 0.5, material = "steel"}
[supports]
root = "ENCASTRE"
[forces]
tip = [0.0, 0.0, 1e-3]
[pressures]
skin = 1e-6
"""


def format22(x: np.ndarray, groups: Groups) -> str:
    names = [f'{DIMENSIONS[kind]} {tag} "{name}"' for tag, (name, kind, _) in enumerate(groups, 1)]
    cells = [
        f"{KINDS[kind]} 2 {tag} {tag} {' '.join(map(str, each))}"
        for tag, (_, kind, of) in enumerate(groups, 1)
        for each in of
    ]
    return "\n".join(
        [
            *(
                "$MeshFormat",
                "2.2 0 8",
                "$EndMeshFormat",
                "$PhysicalNames",
                str(len(names)),
                *names,
                "$EndPhysicalNames",
            ),
            *(
                "$Nodes",
                str(len(x)),
                *(f"{i} {numbers(row).replace(',', '')}" for i, row in enumerate(x, 1)),
                "$EndNodes",
            ),
            *("$Elements", str(len(cells)), *(f"{i} {each}" for i, each in enumerate(cells, 1)), "$EndElements", ""),
        ]
    )


def format41(x: np.ndarray, groups: Groups) -> str:
    """Every group an entity of its own, all nodes on the last one."""
    names, entities, blocks, cell = list[str](), {d: list[str]() for d in range(3)}, list[str](), 0
    for tag, (name, kind, of) in enumerate(groups, 1):
        dimension = DIMENSIONS[kind]
        names.append(f'{dimension} {tag} "{name}"')
        box = "0 0 0" if dimension == 0 else "0 0 0 1 1 1"
        entities[dimension].append(f"{tag} {box} 1 {tag}{'' if dimension == 0 else ' 0'}")
        blocks.append(f"{dimension} {tag} {KINDS[kind]} {len(of)}")
        for each in of:
            cell += 1
            blocks.append(f"{cell} {' '.join(map(str, each))}")
    n, last = len(x), len(groups)
    return "\n".join(
        [
            *(
                "$MeshFormat",
                "4.1 0 8",
                "$EndMeshFormat",
                "$PhysicalNames",
                str(len(names)),
                *names,
                "$EndPhysicalNames",
            ),
            *(
                "$Entities",
                " ".join(str(len(entities[d])) for d in range(3)) + " 0",
                *(each for d in range(3) for each in entities[d]),
            ),
            *("$EndEntities", "$Nodes", f"1 {n} 1 {n}", f"2 {last} 0 {n}", *map(str, range(1, n + 1))),
            *(numbers(row).replace(",", "") for row in x),
            *("$EndNodes", "$Elements", f"{len(groups)} {cell} 1 {cell}", *blocks, "$EndElements", ""),
        ]
    )


X, QUADS = plate(16, 1, 20.0, 2.0)
STRIP: Groups = [("root", "line", [(1, 2)]), ("tip", "line", [(33, 34)]), ("skin", "quad", (QUADS + 1).tolist())]
FORMATS = {"2.2": format22, "4.1": format41}


def put(tmp_path: Path, mesh: str, beside: str | None = BESIDE) -> list[str]:
    (tmp_path / "panel.msh").write_text(mesh)
    if beside is not None:
        (tmp_path / "panel.toml").write_text(beside)
    return ["solve", str(tmp_path / "panel.msh"), "--out", str(tmp_path / "out")]


def said_of(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(words) == WRONG_USE
    said = capsys.readouterr().err.strip()
    assert "\n" not in said
    return said


def solved(tmp_path: Path, mesh: str, beside: str = BESIDE) -> Mapping[str, float]:
    assert main([*put(tmp_path, mesh, beside), "--mesh", "1x1", "--no-error"]) == OK
    return json.loads((tmp_path / "out" / "result.json").read_text())["quantities"]


@pytest.mark.parametrize("form", FORMATS)
def test_a_strip_is_that_of_a_deck(tmp_path, form) -> None:
    """P L^3/(3 E I) + p b L^4/(8 E I) but for shear and 16 elements."""
    seen = solved(tmp_path, FORMATS[form](X, STRIP))
    deck = [
        *mesh_lines(X, QUADS),
        *("*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.", "*SHELL SECTION, ELSET=ALL, MATERIAL=M", "0.5"),
        *("*BOUNDARY", "1, 1, 6", "2, 1, 6", "*NSET, NSET=tip", "33, 34", "*STEP", "*STATIC", "*CLOAD", "tip, 3, 5e-4"),
        *("*DLOAD", "ALL, P, 1e-6", "*END STEP"),
    ]
    other = answered(tmp_path, deck, "--mesh", "1x1", "--no-error")["quantities"]
    assert seen["u3_tip_mm"] == pytest.approx(other["u3_TIP_mm"], rel=1e-12)
    assert seen["reaction_3_N"] == pytest.approx(-1e-3 - 40e-6, rel=1e-9)
    bending = 1000 * 2 * 0.5**3 / 12
    assert seen["u3_tip_mm"] == pytest.approx(1e-3 * 20**3 / (3 * bending) + 2e-6 * 20**4 / (8 * bending), rel=5e-3)


@pytest.mark.parametrize("form", FORMATS)
def test_plies_points_and_degrees(tmp_path, form) -> None:
    """Fibres across the strip in a third of the wall; a force on both corners; all of a clamp by degrees."""
    groups = [STRIP[0], ("tip", "point", [(33,), (34,)]), STRIP[2]]
    wall = 'plies = [[0.1, "fibres", 0.0], [0.1, "fibres", 90.0], [0.1, "fibres", 0.0]], axis = [0.0, 1.0, 0.0]'
    text = BESIDE.replace('thickness = 0.5, material = "steel"', wall).replace("skin = 1e-6", "")
    text = text.replace('"ENCASTRE"', "[1, 2, 3, 4, 5, 6]").replace("[pressures]", "finite_rotations = true")
    text = text.replace(
        "[materials]", "[materials]\nfibres = {E1 = 9000.0, E2 = 1000.0, nu12 = 0.0, G12 = 500.0, G23 = 500.0}"
    )
    text = "finite_rotations = true\n" + text.replace("finite_rotations = true", "")
    seen = solved(tmp_path, FORMATS[form](X, groups), text)
    bending = 2 * (1000 * (0.3**3 - 0.1**3) + 9000 * 0.1**3) / 12
    assert seen["along_forces_mm"] == pytest.approx(1e-3 * 20**3 / (3 * bending), rel=6e-3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[supports]", "[suports]", "has a key suports that is not supported; it must be one of materials, sections"),
        ("nu = 0.0", "mu = 0.0", "materials.steel has a key mu that is not supported"),
        (", nu = 0.0", "", "materials.steel needs nu"),
        ("nu = 0.0", "nu = nan", "materials.steel.nu must lie in"),
        ("nu = 0.0", "nu = 0.5", "materials.steel: nu = 0.5 must lie in (-1, 0.5)"),
        ("E = 1000.0", "E = true", "materials.steel.E must be a number"),
        ('material = "steel"', 'material = "lead"', "sections.skin.material: there is no material lead"),
        ("thickness = 0.5", "thickness = -0.5", "thickness = -0.5 must be a positive number"),
        ('root = "ENCASTRE"', "root = [1, 7]", "supports.root[1] must be one of 1 to 6"),
        ('root = "ENCASTRE"', 'foot = "ENCASTRE"', "foot is not a physical group of the mesh, which has root, tip"),
        ('root = "ENCASTRE"', 'root = "GLUED"', "supports.root: must be one of ENCASTRE, PINNED"),
        ("tip = [0.0, 0.0, 1e-3]", "tip = [0.0, 0.0]", "forces.tip must be a list of 3"),
        ("tip = [0.0, 0.0, 1e-3]", "skin = [0.0, 0.0, 1.0]", "forces.skin must be a group of points, or of lines"),
        ("skin = 1e-6", "tip = 1e-6", "pressures.tip must be a group of quadrilaterals"),
        ("skin = 1e-6", "skin = 1e999", "pressures.skin must lie in [-1e+60, 1e+60]"),
        ("[pressures]", "[pressures", "panel.toml: cannot be read as TOML"),
        ('root = "ENCASTRE"', "", "panel.msh: no support: [supports] of panel.toml"),
        ("[pressures]\nskin = 1e-6", "", None),
    ],
)  # fmt: skip
def test_what_stands_beside_is_refused_by_its_key(tmp_path, capsys, old, new, words) -> None:
    assert old in BESIDE
    asked = put(tmp_path, format41(X, STRIP), BESIDE.replace(old, new))
    if words is None:
        assert main([*asked, "--mesh", "1x1", "--no-error"]) == OK
    else:
        assert words in said_of(asked, capsys)


def test_without_loads_the_tables_of_loads_are_named(tmp_path, capsys) -> None:
    asked = put(tmp_path, format41(X, STRIP), BESIDE[: BESIDE.index("[forces]")])
    says = "no load: [forces], [pressures] of panel.toml, or --set foundation=plane"
    assert said_of(asked, capsys).endswith(f"panel.msh: {says}")


def test_sections_of_two_axes_are_refused_by_their_table(tmp_path, capsys) -> None:
    groups = [*STRIP[:2], ("skin", "quad", (QUADS[:8] + 1).tolist()), ("web", "quad", (QUADS[8:] + 1).tolist())]
    wall = '{{plies = [[0.1, "fibres", 0.0]], axis = [{}]}}'
    text = BESIDE.replace(
        '{thickness = 0.5, material = "steel"}', f"{wall.format('1.0, 0.0, 0.0')}\nweb = {wall.format('0.0, 1.0, 0.0')}"
    )
    text = text.replace(
        "[materials]", "[materials]\nfibres = {E1 = 9000.0, E2 = 1000.0, nu12 = 0.0, G12 = 500.0, G23 = 500.0}"
    )
    says = "plies count from 2 axes, only one axis is supported: [sections] of panel.toml"
    assert says in said_of(put(tmp_path, format41(X, groups), text), capsys)


def without(kind: str, nodes: Sequence[int]) -> Groups:
    return [*STRIP[:2], ("skin", kind, [nodes])]


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize(
    ("groups", "words"),
    [
        (without("triangle", (1, 3, 4)), "has triangles; recombine in gmsh: Recombine Surface {:};"),
        (without("quad9", (1, 3, 4, 2, 5, 6, 7, 8, 9)), "of second order; mesh in gmsh with Mesh.ElementOrder = 1"),
        (without("quad", (1, 3, 3, 2)), "element 1 has a node twice"),
        (STRIP[:2], "0 quadrilaterals, there must be 1 to"),
        ([("root", "line", [(1, 2)]), *STRIP[2:]], "supports.foot is not a physical group"),
    ],
)  # fmt: skip
def test_meshes_that_are_none_of_quadrilaterals(tmp_path, capsys, form, groups, words) -> None:
    beside = BESIDE.replace("root", "foot") if "foot" in words else BESIDE
    assert words in said_of(put(tmp_path, FORMATS[form](X, groups), beside), capsys)


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize(
    "cut", [("34", "77"), ("$EndNodes", ""), ("0.0", "nan"), ("$MeshFormat", "$MashFormat"), (" 8\n", " x\n")]
)
def test_files_that_are_broken_are_refused_in_one_line(tmp_path, capsys, form, cut) -> None:
    whole = FORMATS[form](X + 0.25, STRIP)
    broken = whole.replace(*cut) if cut[0] != "0.0" else whole.replace("0.25", "nan", 1)
    assert broken != whole
    assert "panel.msh" in said_of(put(tmp_path, broken), capsys)


def test_positions_whose_products_would_be_no_numbers_are_refused(tmp_path, capsys) -> None:
    says = "panel.msh: positions of nodes must be three numbers in [-1e+60, 1e+60] each"
    assert says in said_of(put(tmp_path, format41(1e70 * X, STRIP)), capsys)


def test_what_is_missing(tmp_path, capsys, monkeypatch) -> None:
    assert "needs panel.toml beside it" in said_of(put(tmp_path, format41(X, STRIP), None), capsys)
    asked = put(tmp_path, format41(X, STRIP))
    monkeypatch.setitem(sys.modules, "meshio", None)
    assert "meshes of gmsh need the extra mesh: pip install" in said_of(asked, capsys)
    assert main(["solve", str(tmp_path / "none.msh"), "--out", str(tmp_path / "out")]) == WRONG_USE
