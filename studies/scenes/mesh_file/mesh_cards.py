"""Cards of a mesh: nodes, quadrilaterals, normals and sets."""

from studies.scenes.complete import LARGEST_MESH
from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.keywords import Card, shown

QUADS = ("S4", "S4R", "S4RS", "S4R5")
RECOMBINE = "recombine in gmsh: Recombine Surface {:}; with Mesh.SubdivisionAlgorithm = 1 leaves no triangle"
FIRST_ORDER = "mesh in gmsh with Mesh.ElementOrder = 1"
OTHERS = {
    **dict.fromkeys(("S3", "S3R", "S3RS", "STRI3", "M3D3", "CPS3"), f"is a triangle; {RECOMBINE}"),
    **dict.fromkeys(("S6", "STRI65"), f"is a triangle; {RECOMBINE}, Mesh.ElementOrder = 1"),
    **dict.fromkeys(("S8", "S8R", "S8R5", "S9R5"), f"is of second order; {FIRST_ORDER}"),
}


def node(deck: Deck, card: Card) -> None:
    """Number, position and, in Abaqus' further fields, the normal, where it is not zero."""
    card.knows("NSET")
    numbers = []
    for row in card.rows:
        row.at_most(7)
        number = row.whole(0)
        if number in deck.nodes:
            row.refuse(f"node {number} twice")
        deck.nodes[number] = (row.real(1, 0.0), row.real(2, 0.0), row.real(3, 0.0))
        normal = (row.real(4, 0.0), row.real(5, 0.0), row.real(6, 0.0))
        if any(normal):
            deck.normals[number] = [normal]
        numbers.append(number)
    if "NSET" in card.parameters:
        deck.add(deck.node_sets, card.parameter("NSET"), numbers)


def element(deck: Deck, card: Card) -> None:
    """Number and four corners; raises UsageError for any other kind."""
    card.knows("TYPE", "ELSET")
    kind = card.parameter("TYPE")
    if kind not in QUADS:
        understood = f"understood are {', '.join(QUADS)}"
        card.refuse(f", TYPE={shown(kind)} {OTHERS.get(kind, f'is no quadrilateral shell; {understood}')}")
    numbers = []
    for row in card.rows:
        row.at_most(5)
        number, corners = row.whole(0), tuple(row.whole(place) for place in range(1, 5))
        if number in deck.elements:
            row.refuse(f"element {number} twice")
        if len(set(corners)) < 4:
            row.refuse(f"element {number} has a node twice, it is a triangle; {RECOMBINE}")
        deck.elements[number] = corners
        numbers.append(number)
        if len(deck.elements) > LARGEST_MESH:
            row.refuse(f"more than {LARGEST_MESH} elements")
    if "ELSET" in card.parameters:
        deck.add(deck.element_sets, card.parameter("ELSET"), numbers)


def normal(deck: Deck, card: Card) -> None:
    """Element, node and normal; one that several elements tell in several ways is the mean."""
    card.knows("TYPE")
    if card.parameters.get("TYPE", "ELEMENT") != "ELEMENT":
        card.refuse("has a TYPE that is not understood; understood is ELEMENT")
    for row in card.rows:
        row.at_most(5)
        element, node = row.whole(0), row.whole(1)
        normal = (row.real(2), row.real(3), row.real(4))
        if node not in deck.elements.get(element, ()):
            row.refuse(f"there is no element {element} with a node {node}")
        if not any(normal):
            row.refuse(f"the normal of node {node} is zero")
        if normal not in deck.normals.setdefault(node, []):
            deck.normals[node].append(normal)


def node_set(deck: Deck, card: Card) -> None:
    """Of nodes, of other sets, or of the nodes of elements."""
    card.knows("NSET", "GENERATE", "UNSORTED", "ELSET")
    numbers = list(deck.listed(card, deck.nodes, deck.node_sets, "node"))
    if "ELSET" in card.parameters:
        of = deck.members_of(card, card.parameter("ELSET"), deck.elements, deck.element_sets, "element")
        numbers += list(dict.fromkeys(node for each in of for node in deck.elements[each]))
    deck.add(deck.node_sets, card.parameter("NSET"), numbers)


def element_set(deck: Deck, card: Card) -> None:
    """Of elements, or of other sets."""
    card.knows("ELSET", "GENERATE", "UNSORTED")
    numbers = list(deck.listed(card, deck.elements, deck.element_sets, "element"))
    deck.add(deck.element_sets, card.parameter("ELSET"), numbers)
