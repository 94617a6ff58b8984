"""A deck from its file: every card is understood, is named as one without effect, or is refused with its line."""

from collections.abc import Callable
from pathlib import Path

from studies.scenes.mesh_file import cards, local_axes
from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.gmsh import read_gmsh
from studies.scenes.mesh_file.keywords import Card, cards_of

GMSH = ".msh"
SILENT = (  # read, and without effect
    *("HEADING", "NODE FILE", "EL FILE", "NODE PRINT", "EL PRINT", "ENERGY PRINT", "SECTION PRINT", "CONTACT FILE"),
    *("OUTPUT", "NODE OUTPUT", "ELEMENT OUTPUT", "ENERGY OUTPUT", "FILE FORMAT", "PREPRINT", "MONITOR", "DENSITY"),
    "EXPANSION",  # for temperatures are refused
)
OUTPUT_OF_NODES = ("NODE FILE", "NODE PRINT", "NODE OUTPUT")
BEFORE_STEP: dict[str, Callable[[Deck, Card], None]] = {
    "NODE": cards.node,
    "ELEMENT": cards.element,
    "NORMAL": cards.normal,
    "TRANSFORM": local_axes.transform,
    "MATERIAL": cards.material,
    "ELASTIC": cards.elastic,
    "ORIENTATION": cards.orientation,
    "SHELL SECTION": cards.shell_section,
    "NODAL THICKNESS": cards.nodal_thickness,
}
ANYWHERE: dict[str, Callable[[Deck, Card], None]] = {
    "NSET": cards.node_set,
    "ELSET": cards.element_set,
    "BOUNDARY": cards.boundary,
    "STEP": cards.step,
}
IN_STEP: dict[str, Callable[[Deck, Card], None]] = {
    "STATIC": cards.static,
    "CLOAD": cards.cload,
    "DLOAD": cards.dload,
    "END STEP": cards.end_step,
}


def read_deck(path: Path) -> Deck:
    """All cards in order, or a mesh of gmsh; raises UsageError for what is not understood, and OSError."""
    if path.suffix.lower() == GMSH:
        return read_gmsh(path)
    deck = Deck(path)
    for card in cards_of(path):
        _take(deck, card)
    deck.check()
    return deck


def _take(deck: Deck, card: Card) -> None:
    if deck.ended:
        card.refuse("stands behind *END STEP: only one step is supported")
    if card.keyword in SILENT:
        deck.silent[card.keyword] = deck.silent.get(card.keyword, 0) + 1
        name = card.parameters.get("NSET", "")
        if card.keyword in OUTPUT_OF_NODES and name in deck.node_sets:
            deck.see(name)
    elif card.keyword in BEFORE_STEP and deck.steps:
        card.refuse("stands behind *STEP")
    elif card.keyword in IN_STEP and not deck.steps:
        card.refuse("stands before *STEP")
    else:
        take = {**BEFORE_STEP, **ANYWHERE, **IN_STEP}.get(card.keyword)
        if take is None:
            card.refuse("is not supported")
        take(deck, card)
