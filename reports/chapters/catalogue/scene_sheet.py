"""The sheet of a scene: its sketch and picture, what it is made of, what is asked, and what is known of the answer."""

from __future__ import annotations

import pandas as pd

from reports.chapters.catalogue.pictures import filmstrip, sheet_picture
from reports.chapters.catalogue.words import Catalogue, Sheet, about
from reports.formats import number, percent, share
from reports.markdown import Part, joined, listing, picture, prose, table

SOLVED = ("converged", "unstable")
PLY_HEADS = "ply, from inside | thickness [mm] | fibre from a1 [deg] | E_L [MPa] | E_T | G_LT | G_TT | nu_LT | nu_TT"
PLY_LINE = "{ply} | {thickness_mm:g} | {angle_deg:g} | {E_L:g} | {E_T:g} | {G_LT:g} | {G_TT:g} | {nu_LT:g} | {nu_TT:g}"
MEANT_HEADS, MEANT_LINE = "quantity | unit | what it is", "{quantity:code} | {unit} | {definition}"
TARGET_HEADS = "quantity | kind | source | here | target | off by | known to"
TARGET_LINE = "{quantity:code} | {kind} | {source} | {value:g} | {target:g} | {error:off} | {uncertainty:known}"
LIMIT_HEADS = "quantity | limit of finer meshes | ± | finest mesh | here off it by"
LIMIT_LINE = "{quantity:code} | {limit:g} | {limit_uncertainty:known} | {finest_mesh} | {off:off}"


def scene_sheet(catalogue: Catalogue, sheet: Sheet) -> Part:
    """The whole page."""
    name = sheet.part
    answer = catalogue.own("answers", scene=name).iloc[0]
    own = catalogue.own("values", scene=name)
    return joined(
        prose(f"# {sheet.title}\n\n{sheet.meaning}. {_first(own, answer)}"),
        _pictures(catalogue, name),
        about(sheet.about),
        _facts(catalogue, name),
        _targets(own, answer),
        pressed(catalogue) if name == "tyre" else "",
        catalogue.settings("scene", name),
    )


def _first(own: pd.DataFrame, answer: pd.Series) -> str:
    """The answer of the page in one sentence."""
    shown = own[own["headline"].astype(bool) & own["value"].notna()]
    if answer["outcome"] not in SOLVED or shown.empty:
        return f"Here it is {answer['outcome']}." if answer["outcome"] not in SOLVED else "It has no headline quantity."
    best = shown.sort_values("uncertainty", kind="stable").iloc[0]
    unit = "" if best["unit"] == "1" else f" {best['unit']}"
    value = f"`{best['quantity']}` = {number(best['value'])}{unit} on {answer['mesh']}"
    if pd.isna(best["target"]):
        return f"Here {value}; no reference holds at these settings."
    known = f"{best['kind']} target {number(best['target'])}"
    off = "" if best["target"] == 0 else f", {percent(best['error'])} off"
    return f"Here {value}; {known}{off}."


def _pictures(catalogue: Catalogue, name: str) -> Part | str:
    body = catalogue.body(name)
    if body is None:
        return "There is no picture: the cell of this sheet has no fields."
    words = f"{name}: at rest with supports and loads, and deformed with its displacement"
    return picture(f"scene-{name}.svg", words, sheet_picture(body, catalogue.own("marks", scene=name), name))


def _facts(catalogue: Catalogue, name: str) -> Part:
    own, layers = (catalogue.own(each, scene=name) for each in ("facts", "plies"))
    if own.empty:
        return Part("")
    sections = own.groupby("section", sort=False)
    parts = [table(str(name), ["what", "value"], rows[["item", "said"]].to_numpy(), words=2) for name, rows in sections]
    plies = listing("Plies", layers, PLY_HEADS, PLY_LINE) if len(layers) else ""
    return joined("## The problem", *parts, plies)


def _targets(own: pd.DataFrame, answer: pd.Series) -> Part:
    defined = own.drop_duplicates("quantity")
    meant = listing("Quantities", defined, MEANT_HEADS, MEANT_LINE, words=3)
    known = own[own["target"].notna()]
    told = [_ending(answer)]
    if known.empty:
        told.append("No reference holds at these settings.")
    shown = listing("Targets", known, TARGET_HEADS, TARGET_LINE, words=3, off=_off, known=_known) if len(known) else ""
    limits = defined[defined["limit"].notna()]
    limits = limits.assign(off=limits["value"] / limits["limit"] - 1)
    finer = ""
    if len(limits):
        finer = listing("Limits of a ladder of meshes", limits, LIMIT_HEADS, LIMIT_LINE, off=_off, known=_known)
    command = f"```sh\n{answer['command']}\n```"
    return joined("## Quantities and targets", meant, prose("\n\n".join(told)), shown, finer, "## Command", command)


def _ending(answer: pd.Series) -> str:
    if pd.isna(answer["mesh"]) or answer["mesh"] == "":
        return "The cell of this sheet is not solved."
    counts = f"{answer['unknowns']:.0f} unknowns, {answer['iterations']:.0f} Newton iterations"
    how = f"Here: mesh {answer['mesh']}, measure `{answer['measure']}`, model {answer['model']}, {counts}"
    return f"{how}; {answer['outcome']}" + (f": {answer['reason']}." if answer["outcome"] != "converged" else ".")


def _off(error: float) -> str:
    return percent(error, 2)


def _known(uncertainty: float) -> str:
    """In per cent, with two digits where that is small."""
    return f"{100 * uncertainty:.2g} %" if 0 < uncertainty < 1e-4 else share(uncertainty, 2)


def filmstrip_of(catalogue: Catalogue) -> Part | None:
    """The tyre at growing travel; None without its cells."""
    words = "The tyre pressed, from below: contact pressure at growing travel"
    return picture("tyre-filmstrip.svg", words, filmstrip(catalogue.frames)) if catalogue.frames else None


def pressed(catalogue: Catalogue) -> Part | str:
    """The same under a heading, nothing without its cells."""
    strip = filmstrip_of(catalogue)
    return "" if strip is None else joined("## The tyre pressed", strip)
