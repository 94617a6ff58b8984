"""Random panels before a ball or a plane, posed in two ways that must not matter: axes, units, place, numbering, steps.

See :mod:`studies.experiments.symmetry`, whose classes of deviations and whose yardsticks are used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.problem import ContactAlgorithm
from formulations.geometry.surfaces import Plate, Surface, cylinder, sphere, torus
from formulations.strains.catalogue import MEASURES
from studies.experiments.conformance import claims_objectivity
from studies.experiments.rigid_body import rotation
from studies.experiments.specimens import ELEMENTS, FIRST, Motion, Panel, Posed, Way, X, Z, renumbered
from studies.experiments.symmetry import ACCIDENT, against, solved
from studies.fuzz.attempt import CONVERGED, ENDED, REFUSED, Broken, Passed, no_traceback, quiet, watched
from studies.fuzz.comparing import ALIKE, Answer, compared, unstable
from studies.fuzz.state_laws import check_derivatives
from studies.fuzz.values import generator
from studies.solving.disagreement import UNSTABLE

UNITS = 9.0  # powers of ten
SHAPES = ("plate", "cylinder", "sphere", "torus")
WAYS = ("axes exchanged", "other units", "moved and turned", "nodes renumbered", "load steps")


@dataclass(frozen=True, eq=False)
class Drawn:
    """A panel, what solves it, and the other way in which it is posed."""

    panel: Panel
    measure: str
    contact: str
    how: str
    way: Way
    steps: int
    shape: str

    @property
    def about(self) -> str:
        """In words."""
        grid = "x".join(str(len(line) - 1) for line in self.panel.lines)
        pressed = f"ball of {self.panel.radius:.3g}" if self.panel.ball else "plane"
        element = self.panel.element
        by = f"{element.interpolation} {element.thickness_strain} {element.membrane}"
        return f"{self.shape} {grid}, {pressed}, {self.measure}, {by}, {self.contact}: {self.how}"


def drawn_panel(seed: int) -> Drawn:
    """The panel of a number."""
    rng = generator(seed, "panel")
    how, shape = str(rng.choice(WAYS)), str(rng.choice(SHAPES))
    turned = how == "moved and turned"
    elements = [e for e in ELEMENTS if not turned or shape == "plate" or e.interpolation == "isoparametric"]
    element = elements[rng.integers(len(elements))]
    suited = [n for n, m in MEASURES.items() if element.suits(m) and (not turned or claims_objectivity(m))]
    radius, tube = rng.uniform(1.5, 5), rng.uniform(0.8, 2)

    def surface(length: float) -> Surface:
        curved = {"cylinder": cylinder, "sphere": sphere}
        if shape == "torus":
            return torus(radius * length, tube * length)
        return curved[shape](radius * length) if shape in curved else Plate()

    lines = [_spaced(int(rng.integers(3, 6)), rng) for _ in range(2)]
    lengths = {"plate": (True, True), "cylinder": (True, False)}.get(shape, (False, False))
    panel = Panel(
        surface,
        (lines[0], lines[1]),
        lengths,
        Z if shape == "plate" else X,
        bool(shape == "plate" or rng.random() < 0.5),
        element,
        float(rng.uniform(0.3, 2.0)),
        float(10 ** rng.uniform(-3, -0.7)),
    )
    length, stress = (float(10.0 ** rng.uniform(-UNITS, UNITS)) for _ in range(2))
    axis = rng.normal(size=3)
    motion = Motion(rotation(axis / np.linalg.norm(axis), float(rng.uniform(-3, 3))), rng.uniform(-2, 2, size=3))
    way = {
        "axes exchanged": Way(swapped=True),
        "other units": Way(length=length, stress=stress),
        "moved and turned": Way(motion=motion),
    }.get(how, FIRST)
    contact = str(rng.choice(list(ALGORITHMS)))
    return Drawn(panel, str(rng.choice(suited)), contact, how, way, int(rng.integers(2, 5)), shape)


def _spaced(n: int, rng: np.random.Generator) -> np.ndarray:
    """Uneven lines (n + 1,) from about -1/2 to 1/2; the sizes of neighbours differ by three at most."""
    sizes = rng.uniform(1, 3, size=n)
    return np.append(0.0, np.cumsum(sizes)) / sizes.sum() - 0.5


def about(seed: int) -> str:
    """What the number stands for, in words."""
    return drawn_panel(seed).about


def check(seed: int) -> Passed:
    """Both ways, compared; raises Broken."""
    case = drawn_panel(seed)
    measure, algorithm = MEASURES[case.measure], ALGORITHMS[case.contact]()
    first = case.panel.posed(measure)
    other = case.panel.posed(measure, case.way)
    if case.how == "nodes renumbered":
        other = renumbered(first, generator(seed, "numbers"))
    with no_traceback():
        one = solved(_watched(first), algorithm)
        two = solved(_watched(other), algorithm, case.steps if case.how == "load steps" else 1)
        row = against(case.how, one, two)
    with quiet():
        for refused, wrong in ((each.refused, each.wrong) for each in (one, two)):
            if refused:
                return Passed(REFUSED, said=wrong)
            if wrong.startswith("the judge"):
                raise Broken("certified", wrong)
            if wrong:
                return Passed(f"{ENDED}: {wrong}")
        return Passed(CONVERGED, case.how, _said(case, first, other, algorithm, row, seed))


def _said(
    case: Drawn, first: Posed, other: Posed, algorithm: ContactAlgorithm, row: dict[str, object], seed: int
) -> str:
    """The class of the deviation; raises Broken for one that nothing explains."""
    state, _ = first.solved(algorithm)
    problem = first.problem_at(1.0)
    check_derivatives(problem, state, seed)
    deviation = float(str(row["deviation"]))
    if row["class"] != ACCIDENT or deviation <= ALIKE or row["contact_nodes"] == 0:
        return "agrees"
    one = Answer(problem, state, algorithm)
    if case.how == "load steps":
        said = compared(one, Answer(problem, first.solved(algorithm, case.steps)[0], algorithm))
        if said:
            return said
    second = Answer(other.problem_at(1.0), other.solved(algorithm)[0], other.algorithm(algorithm))
    counts = [unstable(each) for each in (one, second)]
    if any(counts):
        return f"{UNSTABLE}: {counts[0]} and {counts[1]} eigenvalues are negative, apart by {deviation:.1e}"
    raise Broken("one answer", f"{case.how}: apart by {deviation:.1e}, rounding {row['rounding']:.1e}")


def _watched(posed: Posed) -> Posed:
    return replace(posed, problem_at=lambda t: watched(posed.problem_at(t)))
