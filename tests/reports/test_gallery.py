"""The sheets: one for every part of the catalogues, none without what is needed to work with it elsewhere."""

from __future__ import annotations

import pandas as pd
import pytest

from contact.catalogue import ALGORITHMS
from formulations.strains.catalogue import MEASURES
from reports.chapter import Chapter
from reports.chapters.catalogue import Catalogue
from reports.chapters.gallery import CHAPTER, sheets, with_appearances
from reports.markdown import Part
from reports.store import Store
from studies.scenes import SCENES
from support.pages import edit_table
from support.stores.answers import BUILT, DRAWN

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
        has = any(quantity in text for quantity in ("**Targets**", "No reference applies at these settings."))
        assert has, name
        assert f"![{name}: at rest" in text or (name not in DRAWN and "No picture:" in text), name
        assert f"\nfootprint solve {name} " in text, name
        for setting in SCENES[name].settings:
            assert f"| `{setting.key}` | " in text, (name, setting.key)
    for name in BUILT:
        for section in ("Geometry", "Supports", "Material", "Plies"):
            assert f"**{section}**" in files[f"sheets/scene-{name}.md"]


def test_a_sheet_links_to_the_pages_that_name_its_part(files: dict[str, str]) -> None:
    ends = files["sheets/scene-tyre.md"].partition("## On other pages")[2]
    assert "](../convergence.md)" in ends
    sheet, pages = page("sheets/scene-ring", CHAPTER.name), (page("a"), page("b"))
    actual = with_appearances({"a.md": "of a ring", "b.md": "| ring | 1 |", sheet.file: "# R"}, [sheet, *pages])
    assert actual[sheet.file].endswith("\n[b](../b.md)\n")


def page(name: str, under: str = "") -> Chapter:
    return Chapter(name, name, "", lambda store: Part(""), under=under)


def test_a_part_from_outside_has_a_sheet(edited: Store) -> None:
    def with_mine(parts: pd.DataFrame) -> pd.DataFrame:
        known = parts[parts["part"].isin(["donnell", "lcp"])]
        return pd.concat([parts, known.assign(part="my-" + known["part"])])

    edit_table(edited.path, "sheet_parts", with_mine)
    texts = {each.file: each.render(edited).text for each in sheets(edited) if "-my-" in each.name}
    assert texts.keys() == {"sheets/measure-my-donnell.md", "sheets/algorithm-my-lcp.md"}
    assert all("my-" in text for text in texts.values())


def test_a_campaign_without_these_cells_has_no_sheets(edited: Store) -> None:
    (edited.path / "tables/sheet_points.csv").unlink()
    assert not CHAPTER.applies(edited)
    assert sheets(edited) == []


@pytest.mark.slow
def test_pictures_of_sheets_are_small_and_whole(drawn: dict[str, str], loaded: Store) -> None:
    for name in DRAWN:
        svg = drawn[f"figures/scene-{name}.svg"]
        assert 5_000 < len(svg) < 150_000
        assert svg.count("data:image/webp;base64,") == 2
    assert len(Catalogue.of(loaded).frames) == 6
    assert drawn["figures/tyre-filmstrip.svg"].count("<image") == 6
