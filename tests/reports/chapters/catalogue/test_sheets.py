"""The sheets: one for every part of the catalogues, none without what is needed to work with it elsewhere."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from reports.chapter import Chapter
from reports.chapters.catalogue import Catalogue
from reports.chapters.gallery import CHAPTER, sheets, with_appearances
from reports.markdown import Part
from reports.store import load_store
from studies.scenes import SCENES
from support.pages.changed import edit_table
from support.stores.sheets import BUILT, DRAWN

PARTS = {
    **{f"sheets/scene-{name}.md": name for name in SCENES},
    **{f"sheets/measure-{name}.md": name for name in MEASURES},
    **{f"sheets/algorithm-{name}.md": name for name in ALGORITHMS},
}


def test_every_part_has_a_sheet_that_the_gallery_links_to(files: dict[str, str]) -> None:
    assert {name for name in files if name.startswith("sheets/")} == PARTS.keys()
    for name, part in PARTS.items():
        assert f"[{part}]({name})" in files["gallery.md"]
        assert "up: [Gallery](../gallery.md)" in files[name]


def test_no_sheet_of_a_scene_lacks_a_target_a_picture_or_its_settings(files: dict[str, str]) -> None:
    for name in SCENES:
        text = files[f"sheets/scene-{name}.md"]
        has = any(quantity in text for quantity in ("**Targets**", "No reference holds at these settings."))
        assert has, name
        assert f"![{name}: at rest" in text or (name not in DRAWN and "There is no picture" in text), name
        assert f"\nfootprint solve {name} " in text, name
        for setting in SCENES[name].settings:
            assert f"| `{setting.key}` | " in text, (name, setting.key)
    for name in BUILT:
        for section in ("Geometry", "Supports", "Material", "Plies"):
            assert f"**{section}**" in files[f"sheets/scene-{name}.md"]


def test_targets_stand_beside_what_was_found(files: dict[str, str]) -> None:
    text = files["sheets/scene-cantilever.md"]
    source = "inextensible elastica, elliptic integrals"  # what was found is the reference that comes last
    assert f"| `tip_deflection_mm` | exact | {source} | 6.698 | 6.69964 | -0.02 % | 0.001 % |" in text
    assert "(0, 0, 4) N in all along the edge a1 = 10, dead" in text
    assert "| edge a1 = 0 | clamped: neither face moves |" in text
    assert "rigid plane n.x = 1.5 mm, n = (0, 0, 1)" in files["sheets/scene-strip-contact.md"]


def test_a_measure_says_its_terms_what_it_drops_and_where_it_holds(files: dict[str, str]) -> None:
    text = files["sheets/measure-von-karman.md"]
    assert "| `E11` | l1 + 1/2 t1² | + 1/2 l1² + 1/2 w1² |" in text
    assert "| drilling | Cosine of theta less 1, about -theta^2/2: the linear law. | -0.00499583 |" in text
    assert "| `hemisphere` at load_fraction=1: force_N | -20.0 % ± 0.1 % |" in files["sheets/measure-donnell.md"]
    assert "nothing" in files["sheets/measure-exact.md"]


def test_a_sheet_links_to_the_pages_that_name_its_part(files: dict[str, str]) -> None:
    ends = files["sheets/scene-tyre.md"].partition("## On other pages")[2]
    assert "](../convergence.md)" in ends
    sheet, pages = page("sheets/scene-ring", CHAPTER.name), (page("a"), page("b"))
    found = with_appearances({"a.md": "of a ring", "b.md": "| ring | 1 |", sheet.file: "# R"}, [sheet, *pages])
    assert found[sheet.file].endswith("\n[b](../b.md)\n")


def page(name: str, under: str = "") -> Chapter:
    return Chapter(name, name, "", lambda store: Part(""), under=under)


def test_a_part_from_outside_has_a_sheet(own_store: Path) -> None:
    def with_mine(parts: pd.DataFrame) -> pd.DataFrame:
        known = parts[parts["part"].isin(["donnell", "lcp"])]
        return pd.concat([parts, known.assign(part="my-" + known["part"])])

    edit_table(own_store, "sheet_parts", with_mine)
    store = load_store(own_store)
    texts = {each.file: each.render(store).text for each in sheets(store) if "-my-" in each.name}
    assert texts.keys() == {"sheets/measure-my-donnell.md", "sheets/algorithm-my-lcp.md"}
    assert all("my-" in text for text in texts.values())


def test_a_campaign_without_these_cells_has_no_sheets(own_store: Path) -> None:
    (own_store / "tables/sheet_points.csv").unlink()
    store = load_store(own_store)
    assert not CHAPTER.applies(store)
    assert sheets(store) == []


@pytest.mark.slow
def test_pictures_of_sheets_are_small_and_whole(drawn: dict[str, str], store: Path) -> None:
    for name in DRAWN:
        svg = drawn[f"figures/scene-{name}.svg"]
        assert 5_000 < len(svg) < 150_000
        assert svg.count("data:image/webp;base64,") == 2
    assert len(Catalogue.of(load_store(store)).frames) == 6
    assert drawn["figures/tyre-filmstrip.svg"].count("<image") == 6
