"""Cards of supports, loads and the step."""

from studies.scenes.mesh_file.deck import Deck
from studies.scenes.mesh_file.keywords import Card, named, shown

NAMED = {  # supports by name, as degrees of freedom
    "ENCASTRE": (1, 2, 3, 4, 5, 6),
    "PINNED": (1, 2, 3),
    "XSYMM": (1, 5, 6),
    "YSYMM": (2, 4, 6),
    "ZSYMM": (3, 4, 5),
}


def boundary(deck: Deck, card: Card) -> None:
    """Degrees of freedom that are held, by number or by name, at a value; the last value of a displacement counts."""
    card.knows("OP", "TYPE")
    if card.parameters.get("OP", "MOD") != "MOD" or card.parameters.get("TYPE", "DISPLACEMENT") != "DISPLACEMENT":
        card.refuse("is understood with OP=MOD and TYPE=DISPLACEMENT alone")
    for row in card.rows:
        row.at_most(4)
        nodes = deck.members_of(row, row.text(0), deck.nodes, deck.node_sets, "node")
        word = named(row.text(1))
        if word in NAMED:
            held: tuple[int, ...] = NAMED[word]
        else:
            first = row.whole(1)
            last = row.whole(2, first)
            if not first <= last <= 6:
                row.refuse(f"degrees of freedom {first} to {last}: understood are 1 to 6")
            held = tuple(range(first, last + 1))
        value = row.real(3, 0.0)
        if value != 0.0 and not set(held) <= {1, 2, 3}:
            row.refuse(f"a prescribed rotation of {row.text(3)} is not understood, 0 is")
        for node in nodes:
            deck.degrees.setdefault(node, set()).update(held)
            deck.moved.setdefault(node, {}).update((degree, value) for degree in held if degree <= 3)


def cload(deck: Deck, card: Card) -> None:
    """Forces and moments, one on a node along or about an axis."""
    card.knows("OP")
    _checked(card)
    for row in card.rows:
        row.at_most(3)
        degree = row.whole(1)
        if degree > 6:
            row.refuse(f"degree of freedom {degree}: understood are 1 to 6")
        word, value = row.text(0), row.real(2)
        for node in deck.members_of(row, word, deck.nodes, deck.node_sets, "node"):
            forces = deck.forces.setdefault(node, {})
            if degree in forces:
                row.refuse(f"a second load on node {node}, degree {degree}: programs differ in whether they add up")
            forces[degree] = value
        if named(word) in deck.node_sets:
            deck.see(named(word))


def dload(deck: Deck, card: Card) -> None:
    """Pressures along the normals of elements."""
    card.knows("OP")
    _checked(card)
    for row in card.rows:
        row.at_most(3)
        label = named(row.text(1))
        if label != "P":
            row.refuse(f"a load {shown(label)} is not understood: P is, pressure along the normal")
        value = row.real(2)
        for element in deck.members_of(row, row.text(0), deck.elements, deck.element_sets, "element"):
            if element in deck.pressures:
                row.refuse(f"a second pressure on element {element}: programs differ in whether they add up")
            deck.pressures[element] = value


def _checked(card: Card) -> None:
    if card.parameters.get("OP", "MOD") not in ("MOD", "NEW"):
        card.refuse("has an OP that is not understood; understood are MOD, NEW")


def step(deck: Deck, card: Card) -> None:
    """Whether rotations are finite."""
    card.knows("NLGEOM", "INC", "NAME", "PERTURBATION")
    if deck.steps:
        card.refuse("is a second one: one step is understood")
    word = card.parameters.get("NLGEOM", "NO") or "YES"
    if word not in ("YES", "NO"):
        card.refuse(f", NLGEOM={shown(word)} is not understood; understood are YES, NO")
    deck.steps, deck.nonlinear = 1, word == "YES"


def static(deck: Deck, card: Card) -> None:
    """Its increments have no effect: load fractions and steps are those of the solve."""
    card.knows("DIRECT", "SOLVER")
    deck.static = True
    if card.rows:
        deck.silent["STATIC (increments)"] = 1


def end_step(deck: Deck, card: Card) -> None:
    """Nothing may follow."""
    card.knows()
    deck.ended = True
