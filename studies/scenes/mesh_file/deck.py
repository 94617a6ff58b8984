"""What a deck says of a shell, in its own numbers. No geometry and no keyword enters here."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from studies.ask.request import UsageError
from studies.scenes.mesh_file.keywords import Card, Place, Row, listed, named, shown

MOST_MEMBERS = 4_000_000  # of all sets


@dataclass(frozen=True)
class Layer:
    """A ply of a section: thickness [mm], material, angle [deg] from the first axis."""

    thickness: float
    material: str
    angle: float
    row: Place = field(compare=False)


@dataclass(frozen=True)
class Section:
    """Plies from inside and the name of their axes; nodal: one of 1 mm, which the nodes say how often there is."""

    layers: tuple[Layer, ...]
    orientation: str
    nodal: bool


@dataclass(frozen=True)
class Elastic:
    """Constants of a material as they stand: kind ISOTROPIC, LAMINA or ENGINEERING CONSTANTS."""

    kind: str
    values: tuple[float, ...]
    card: Place


@dataclass(frozen=True)
class Transform:
    """Axes by two points a and b: rectangular, or cylindrical about the line through both."""

    cylindrical: bool
    a: tuple[float, ...]
    b: tuple[float, ...]


@dataclass
class Deck:
    """What was read; numbers of nodes and elements are those of the deck.

    nodes: positions.  normals: all that the deck has of a node.  elements: four nodes each.  degrees: held, by node.
    sections, section_of: those that differ, with their numbers, and that of an element.  thickness: of nodes.
    transforms, systems: axes of degrees and forces, and which of them a node has, the global ones where it has none.
    supports: by set that is held, the share that it has of its nodes, and of those between them.
    moved: values of held degrees 1 to 3.  forces: degree and value by node, moments are 4, 5 and 6.  pressures: by
    element, along its normal.  seen: sets that loads or output requests name.  silent: keywords without effect, how
    often each.  beside: the TOML of a mesh of gmsh, whose tables stand in the place of keywords.
    """

    path: Path
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    normals: dict[int, list[tuple[float, float, float]]] = field(default_factory=dict)
    elements: dict[int, tuple[int, ...]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    element_sets: dict[str, list[int]] = field(default_factory=dict)
    materials: dict[str, Elastic | None] = field(default_factory=dict)
    sections: dict[Section, int] = field(default_factory=dict)
    section_of: dict[int, int] = field(default_factory=dict)
    thickness: dict[int, float] = field(default_factory=dict)
    orientations: dict[str, tuple[tuple[float, ...], float]] = field(default_factory=dict)
    transforms: list[Transform] = field(default_factory=list)
    systems: dict[int, int] = field(default_factory=dict)
    moved: dict[int, dict[int, float]] = field(default_factory=dict)
    degrees: dict[int, set[int]] = field(default_factory=dict)
    supports: dict[str, dict[int, float]] = field(default_factory=dict)
    forces: dict[int, dict[int, float]] = field(default_factory=dict)
    pressures: dict[int, float] = field(default_factory=dict)
    seen: list[str] = field(default_factory=list)
    silent: dict[str, int] = field(default_factory=dict)
    steps: int = 0
    nonlinear: bool = False
    static: bool = False
    ended: bool = False
    material: str = ""
    members: int = 0
    beside: Path | None = None

    def words(self, keywords: str, *tables: str) -> str:
        """Where a user says something: by keywords, or in tables beside a mesh of gmsh."""
        return keywords if self.beside is None else f"{', '.join(f'[{each}]' for each in tables)} of {self.beside.name}"

    def check(self) -> None:
        """Raise UsageError for what is missing, and for what names nothing."""
        name = self.path.name
        for missing, what in (
            (self.elements, "no quadrilaterals: *ELEMENT, TYPE=S4"),
            (self.sections, "no *SHELL SECTION"),
            (self.static, "no *STEP with *STATIC"),
            (self.degrees, f"no support: {self.words('*BOUNDARY', 'supports')}"),
        ):
            if not missing:
                raise UsageError(f"{name}: {what}")
        for layer in (layer for section in self.sections for layer in section.layers):
            if self.materials.get(layer.material) is None:
                layer.row.refuse(f"there is no material {shown(layer.material)} with *ELASTIC")
            if layer.thickness <= 0:
                layer.row.refuse(f"thickness = {layer.thickness:g} must be a positive number")
        bare = [each for each in self.elements if each not in self.section_of]
        if bare:
            raise UsageError(f"{name}: no *SHELL SECTION for the elements {listed(bare)}")
        nodal = {number for section, number in self.sections.items() if section.nodal}
        thick = {node for each, of in self.section_of.items() if of in nodal for node in self.elements[each]}
        unknown = sorted(thick - self.thickness.keys())
        if unknown:
            raise UsageError(f"{name}: no *NODAL THICKNESS of the nodes {listed(unknown)}")
        for number, corners in self.elements.items():
            lost = [node for node in corners if node not in self.nodes]
            if lost:
                raise UsageError(f"{name}: element {number} names node {lost[0]}, which is not there")
        used = {node for corners in self.elements.values() for node in corners}
        for what, of in (("force", self.forces), ("support", self.degrees)):
            lost = [node for node in of if node not in used]
            if lost:
                raise UsageError(f"{name}: a {what} on nodes of no element: {listed(lost)}")
        loose = self._unsupported()
        if loose:
            raise UsageError(
                f"{name}: no support on the part of the elements {listed(loose)}, which have no node in common with "
                "the others: where two nodes stand at one place, merge them"
            )

    def _unsupported(self) -> list[int]:
        """The elements that no chain of elements with common nodes joins to a node which is held in any degree."""
        labels, corners = list(self.elements), np.array(list(self.elements.values()))
        _, nodes = np.unique(corners, return_inverse=True)
        first, others = np.repeat(nodes.reshape(-1, 4)[:, :1], 3, axis=1).ravel(), nodes.reshape(-1, 4)[:, 1:].ravel()
        links = coo_array((np.ones(len(first), bool), (first, others)), shape=2 * (nodes.max() + 1,))
        part = connected_components(links, directed=False)[1][nodes.reshape(-1, 4)]
        held = np.isin(part[:, 0], part[np.isin(corners, list(self.degrees))])
        return [label for label, each in zip(labels, held.tolist(), strict=True) if not each]

    def listed(
        self,
        card: Card,
        known: Collection[int],
        sets: dict[str, list[int]],
        what: str,
    ) -> Iterator[int]:
        """The numbers of a set, which may name other sets, or give first, last and step."""
        numbers: Sequence[int]
        for row in card.rows:
            if self.members > MOST_MEMBERS:
                row.refuse(f"more than {MOST_MEMBERS} members of sets")
            if "GENERATE" in card.parameters:
                row.at_most(3)
                numbers = range(row.whole(0), row.whole(1) + 1, row.whole(2, 1))
                if len(numbers) > len(known):
                    row.refuse(f"{len(numbers)} {what}s, of {len(known)} that there are")
                for number in numbers:
                    if number not in known:
                        row.refuse(f"there is no {what} {number}")
                yield from numbers
                self.members += len(numbers)
            else:
                for word in filter(None, row.fields):
                    numbers = self.members_of(row, word, known, sets, what)
                    yield from numbers
                    self.members += len(numbers)

    def members_of(
        self,
        at: Row | Card,
        word: str,
        known: Collection[int],
        sets: dict[str, list[int]],
        what: str,
    ) -> list[int]:
        """The number itself, or the members of the set of that name."""
        if word.isascii() and word.isdigit():
            if len(word) > 12 or int(word) not in known:
                at.refuse(f"there is no {what} {shown(word)}")
            return [int(word)]
        if named(word) not in sets:
            at.refuse(f"there is no set of {what}s {shown(named(word))}")
        return sets[named(word)]

    def add(self, sets: dict[str, list[int]], name: str, numbers: Collection[int]) -> None:
        """Put numbers into a set, which may be there already."""
        sets[name] = list(dict.fromkeys([*sets.get(name, []), *numbers]))

    def see(self, name: str) -> None:
        """Read off the displacements of a set."""
        if name not in self.seen:
            self.seen.append(name)
