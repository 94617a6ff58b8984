"""Random contact problems that are not requests of scenes: matrices made from their answer, and panels posed twice.

Matrices, of a few unknowns: displacements, pressures and gaps are chosen. f = K u - G^T W p and g0 = g - G u make
(u, p) the answer, with p > 0 and g = -p/epsilon at some candidates, p = 0 and g > 0 at others, and both zero at the
rest: touch without pressure. The symmetric part of K is positive definite, so u and the contact forces are unique. No
two candidates share an unknown, as nodes before an obstacle do not; sizes differ by powers of ten.

Panels, before a ball or a plane, are posed in two ways that must not matter: axes, units, place, numbering, steps. See
:mod:`studies.experiments.symmetry`, whose classes of deviations and whose yardsticks are used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome, linear_mechanics
from contact.verify import claim, judge
from formulations.geometry.surfaces import Plate, Surface, cylinder, sphere, torus
from formulations.strains.catalogue import MEASURES
from studies.ask.settings import configured, parameters_of
from studies.experiments.conformance import claims_objectivity
from studies.experiments.rigid_body import rotation
from studies.experiments.specimens import ELEMENTS, FIRST, Motion, Panel, Posed, Way, X, Z, renumbered
from studies.experiments.symmetry import ACCIDENT, against, solved
from studies.fuzz.attempt import CONVERGED, ENDED, REFUSED, Broken, Passed, counter, no_traceback, one_line, quiet
from studies.fuzz.comparing import ALIKE, Answer, compared, unstable
from studies.fuzz.state_laws import check_derivatives
from studies.fuzz.values import drawn, generator
from studies.solving.disagreement import UNSTABLE

MOST_UNKNOWNS, MOST_CANDIDATES = 12, 6
SPREAD, UNITS = 2.0, 3.0  # powers of ten: of the eigenvalues of K, of the sizes of forces and areas
PRESSED, TOUCHING = 0.4, 0.25  # shares of the candidates
SETTINGS = 2  # parameters of the algorithm that leave their defaults


def algorithm_of(seed: int) -> tuple[str, dict[str, str]]:
    """The algorithm of a case and those of its parameters that are drawn."""
    rng = generator(seed, "algorithm")
    contact = str(rng.choice(list(ALGORITHMS)))
    known = {setting.key: setting for setting in parameters_of(contact) if setting.key != "solver"}
    keys = rng.permutation(list(known))[: int(rng.integers(0, SETTINGS + 1))]
    return contact, {str(key): drawn(known[key], seed) for key in keys}


def made(seed: int, epsilon: float) -> tuple[ContactProblem, ContactSolution]:
    """A problem and its answer."""
    rng = generator(seed, "matrices")
    n = int(rng.integers(1, MOST_UNKNOWNS + 1))
    m = int(rng.integers(1, min(n, MOST_CANDIDATES) + 1))
    owner = np.append(np.arange(m), rng.integers(-1, m, size=n - m))  # -1: an unknown that moves no candidate
    Q, _ = np.linalg.qr(rng.normal(size=(n, n)))
    force, area = 10.0 ** rng.uniform(-UNITS, UNITS, size=2)
    K = (Q * 10.0 ** rng.uniform(-SPREAD, SPREAD, size=n)) @ Q.T
    K = force * (K + K.T) / 2
    if rng.random() < 0.2:  # as under loads that follow
        skew = rng.normal(size=(n, n))
        K = K + 0.3 * float(np.linalg.norm(K)) / n * (skew - skew.T) / 2
    G = rng.normal(size=(m, n)) * (rng.permutation(owner) == np.arange(m)[:, None])
    weights = area * 10.0 ** rng.uniform(-1, 1, size=m)
    state = rng.random(m)
    pressed, touching = state < PRESSED, (state >= PRESSED) & (state < PRESSED + TOUCHING)
    p = np.where(pressed, rng.uniform(0.1, 1, size=m) * force / area, 0.0)
    g = np.where(pressed, -p / epsilon, np.where(touching, 0.0, rng.uniform(0.1, 1, size=m)))
    u = rng.normal(size=n)
    g0, f = g - G @ u, K @ u - G.T @ (weights * p)
    rows = sparse.csr_matrix(G)
    problem = ContactProblem(linear_mechanics(sparse.csc_matrix(K), f), lambda x: g0 + G @ x, lambda x: rows, weights)
    return problem, ContactSolution(u, p, p > 0, Outcome.CONVERGED)


def about_matrices(seed: int) -> str:
    """The algorithm and its parameters, in words."""
    contact, settings = algorithm_of(seed)
    return " ".join([contact, *(f"{key}={value}" for key, value in settings.items())])


def check_matrices(seed: int) -> Passed:
    """Solve, judge, and compare with the answer; raises Broken."""
    contact, given = algorithm_of(seed)
    values = {s.key: s.parse(given[s.key]) for s in parameters_of(contact) if s.key in given}
    try:
        algorithm = configured(contact, values)
    except ValueError as error:
        return Passed(REFUSED, said=one_line(str(error)))
    problem, answer = made(seed, algorithm.epsilon)
    refused = algorithm.supports(problem)
    if refused is not None:
        return Passed(REFUSED, said=one_line(refused))
    with no_traceback():
        rest = ContactSolution.at_rest(len(answer.u), len(answer.pressure))
        solution = algorithm.solve(problem.watched(counter()), rest)
    with quiet():
        return _compared_with(algorithm, problem, solution, answer)


def _compared_with(
    algorithm: ContactAlgorithm, problem: ContactProblem, solution: ContactSolution, answer: ContactSolution
) -> Passed:
    if solution.outcome is Outcome.REFUSED:
        return Passed(REFUSED, said=one_line(str(solution.history[-1].get("event", ""))))
    if not solution.outcome.converged:
        return Passed(f"{ENDED}: {solution.outcome.word}")
    tolerance = float(getattr(algorithm, "tolerance", RESIDUAL_TOLERANCE))
    verdict = judge(problem, solution.u, solution.pressure, epsilon=algorithm.epsilon)
    failures = verdict.failures(**claim(tolerance, len(solution.u)))
    if failures:
        values = ", ".join(f"{name} {value:.2e}" for name, value in {**verdict.kkt, **verdict.balances}.items())
        raise Broken("certified", f"{', '.join(failures)}: {values}")
    difference = compared(*(Answer(problem, state, algorithm) for state in (answer, solution)))
    if not difference or difference.startswith("two"):  # K is definite: there is one answer
        raise Broken("the made answer", "converged to another state")
    return Passed(CONVERGED, "the made answer", difference)


SCALES = 9.0  # powers of ten of the units of a panel
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
    length, stress = (float(10.0 ** rng.uniform(-SCALES, SCALES)) for _ in range(2))
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


def about_panel(seed: int) -> str:
    """What the number stands for, in words."""
    return drawn_panel(seed).about


def check_panel(seed: int) -> Passed:
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
    if row["class"] != ACCIDENT or deviation <= ALIKE or not np.any(state.pressure > 0):
        return "agrees"
    one = Answer(problem, state, algorithm)
    if case.how == "load steps":
        difference = compared(one, Answer(problem, first.solved(algorithm, case.steps)[0], algorithm))
        if difference:
            return difference
    second = Answer(other.problem_at(1.0), other.solved(algorithm)[0], other.algorithm(algorithm))
    counts = [unstable(each) for each in (one, second)]
    if any(counts):
        return f"{UNSTABLE}: {counts[0]} and {counts[1]} eigenvalues are negative, apart by {deviation:.1e}"
    raise Broken("one answer", f"{case.how}: apart by {deviation:.1e}, rounding {row['rounding']:.1e}")


def _watched(posed: Posed) -> Posed:
    return replace(posed, problem_at=lambda t: posed.problem_at(t).watched(counter()))
