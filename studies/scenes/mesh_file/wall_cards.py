"""Cards of the wall: materials, axes, the section with its plies."""

from collections.abc import Iterator

from studies.scenes.mesh_file.deck import Deck, Elastic, Layer, Section
from studies.scenes.mesh_file.keywords import Card, Row, listed, named, shown

MOST_SECTIONS = 4000


def material(deck: Deck, card: Card) -> None:
    """Its name."""
    card.knows("NAME")
    deck.material = card.parameter("NAME")
    if deck.material in deck.materials:
        card.refuse(f"{shown(deck.material)} twice")
    deck.materials[deck.material] = None


def elastic(deck: Deck, card: Card) -> None:
    """Constants at one temperature."""
    card.knows("TYPE")
    if not deck.material or deck.materials[deck.material] is not None:
        card.refuse("belongs to a *MATERIAL of its own")
    kind = card.parameters.get("TYPE") or "ISOTROPIC"
    constants = {"ISOTROPIC": 2, "ISO": 2, "LAMINA": 6, "ENGINEERING CONSTANTS": 9}
    if kind not in constants:
        card.refuse(f", TYPE={shown(kind)} is not understood; understood are {', '.join(constants)}")
    count, fields = constants[kind], [field for row in card.rows for field in row.fields]
    if len(card.rows) != 1 + (count > 8) or not count <= len(fields) <= count + 1:
        card.refuse(f"needs {count} constants at one temperature, on {1 + (count > 8)} lines")
    row = Row(card.file, card.line, tuple(fields))
    values = tuple(row.real(place) for place in range(count))
    deck.materials[deck.material] = Elastic("ISOTROPIC" if kind == "ISO" else kind, values, card)


def orientation(deck: Deck, card: Card) -> None:
    """Its first axis [a1 a2 a3] is laid on the shell; the second line must turn it about the third axis."""
    card.knows("NAME", "SYSTEM", "DEFINITION")
    if card.parameters.get("SYSTEM", "RECTANGULAR") not in ("RECTANGULAR", "R"):
        card.refuse("has a SYSTEM that is not understood; understood is RECTANGULAR")
    if card.parameters.get("DEFINITION", "COORDINATES") != "COORDINATES":
        card.refuse("has a DEFINITION that is not understood; understood is COORDINATES")
    if len(card.rows) != 2 or card.rows[1].whole(0) != 3:
        card.refuse("needs a second line that begins with 3: programs differ in which axis they lay on a shell")
    first, second = card.rows
    first.at_most(6)
    second.at_most(2)
    axis = tuple(first.real(place, 0.0) for place in range(3))
    deck.orientations[card.parameter("NAME")] = (axis, second.real(1, 0.0))


def shell_section(deck: Deck, card: Card) -> None:
    """Thickness and material, or plies, of a set of elements."""
    card.knows("ELSET", "MATERIAL", "COMPOSITE", "ORIENTATION", "OFFSET", "NODAL THICKNESS")
    if "OFFSET" in card.parameters and card.parameter("OFFSET") not in ("0", "0.", "0.0"):
        card.refuse(": OFFSET is not understood: programs do not count it the same way")
    name, orientation = card.parameter("ELSET"), card.parameters.get("ORIENTATION", "")
    if orientation and orientation not in deck.orientations:
        card.refuse(f"names an orientation {shown(orientation)} that is not there")
    section = Section(tuple(_layers(deck, card)), orientation, "NODAL THICKNESS" in card.parameters)
    number = deck.sections.setdefault(section, len(deck.sections))
    if number == MOST_SECTIONS:
        card.refuse(f"is one of more than {MOST_SECTIONS} that differ")
    elements = deck.members_of(card, name, {}, deck.element_sets, "element")
    twice = [each for each in elements if each in deck.section_of]
    if twice:
        card.refuse(f"is the second one of the elements {listed(twice)}")
    deck.section_of.update(dict.fromkeys(elements, number))


def nodal_thickness(deck: Deck, card: Card) -> None:
    """Of nodes, for sections that leave it to them."""
    card.knows()
    for row in card.rows:
        row.at_most(2)
        value = row.real(1)
        if not value > 0:
            row.refuse(f"a thickness of {value:g} must be a positive number")
        for node in deck.members_of(row, row.text(0), deck.nodes, deck.node_sets, "node"):
            if deck.thickness.setdefault(node, value) != value:
                row.refuse(f"a second thickness of node {node}: programs differ in which they take")


def _layers(deck: Deck, card: Card) -> Iterator[Layer]:
    if "COMPOSITE" not in card.parameters:
        row = card.only_row()
        row.at_most(2)  # the second counts points across the wall, which is integrated exactly
        by_section = "NODAL THICKNESS" not in card.parameters
        yield Layer(row.real(0) if by_section else 1.0, card.parameter("MATERIAL"), 0.0, row)
        return
    if "NODAL THICKNESS" in card.parameters:
        card.refuse(": NODAL THICKNESS of a COMPOSITE is not understood: programs differ in whether plies grow")
    if not card.rows:
        card.refuse("has no plies")
    for row in card.rows:
        row.at_most(5)
        if named(row.text(3, "0")) in deck.orientations:
            row.refuse("the orientation of a ply by name is not understood, an angle in degrees is")
        yield Layer(row.real(0), named(row.text(2)), row.real(3, 0.0), row)
