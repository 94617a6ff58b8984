"""Cards of a deck: mesh and sets, materials and sections of the wall, supports, loads and the step."""

from collections.abc import Iterator

from studies.scenes.complete import LARGEST_MESH
from studies.scenes.mesh_file.deck import Deck, Elastic, Layer, Section
from studies.scenes.mesh_file.keywords import Card, Row, listed, named, shown

QUADS = ("S4", "S4R", "S4RS", "S4R5")
RECOMBINE = "recombine in gmsh: Recombine Surface {:}; with Mesh.SubdivisionAlgorithm = 1 leaves no triangle"
FIRST_ORDER = "mesh in gmsh with Mesh.ElementOrder = 1"
OTHER_KINDS = {
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
        understood = f"it must be one of {', '.join(QUADS)}"
        card.refuse(f", TYPE={shown(kind)} {OTHER_KINDS.get(kind, f'is not a quadrilateral shell; {understood}')}")
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
        card.refuse("has a TYPE that is not supported; it must be ELEMENT")
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
        card.refuse(f", TYPE={shown(kind)} is not supported; it must be one of {', '.join(constants)}")
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
        card.refuse("has a SYSTEM that is not supported; it must be RECTANGULAR")
    if card.parameters.get("DEFINITION", "COORDINATES") != "COORDINATES":
        card.refuse("has a DEFINITION that is not supported; it must be COORDINATES")
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
        card.refuse(": OFFSET is not supported: programs do not count it the same way")
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
        card.refuse(": NODAL THICKNESS of a COMPOSITE is not supported: programs differ in whether plies grow")
    if not card.rows:
        card.refuse("has no plies")
    for row in card.rows:
        row.at_most(5)
        if named(row.text(3, "0")) in deck.orientations:
            row.refuse("the orientation of a ply by name is not supported, an angle in degrees is")
        yield Layer(row.real(0), named(row.text(2)), row.real(3, 0.0), row)


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
        card.refuse("is supported with OP=MOD and TYPE=DISPLACEMENT only")
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
                row.refuse(f"degrees of freedom {first} to {last} must lie in 1 to 6, the lower first")
            held = tuple(range(first, last + 1))
        if named(row.text(0)) in deck.node_sets:
            deck.supports.setdefault(named(row.text(0)), {}).update(dict.fromkeys(nodes, 1.0))
        value = row.real(3, 0.0)
        if value != 0.0 and not set(held) <= {1, 2, 3}:
            row.refuse(f"a prescribed rotation of {row.text(3)} is not supported, 0 is")
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
            row.refuse(f"degree of freedom {degree} must be 1 to 6")
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
            row.refuse(f"a load {shown(label)} is not supported: P is, pressure along the normal")
        value = row.real(2)
        for element in deck.members_of(row, row.text(0), deck.elements, deck.element_sets, "element"):
            if element in deck.pressures:
                row.refuse(f"a second pressure on element {element}: programs differ in whether they add up")
            deck.pressures[element] = value


def _checked(card: Card) -> None:
    if card.parameters.get("OP", "MOD") not in ("MOD", "NEW"):
        card.refuse("has an OP that is not supported; it must be MOD or NEW")


def step(deck: Deck, card: Card) -> None:
    """Whether rotations are finite."""
    card.knows("NLGEOM", "INC", "NAME", "PERTURBATION")
    if deck.steps:
        card.refuse("is a second one: only one step is supported")
    word = card.parameters.get("NLGEOM", "NO") or "YES"
    if word not in ("YES", "NO"):
        card.refuse(f", NLGEOM={shown(word)} is not supported; it must be YES or NO")
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
