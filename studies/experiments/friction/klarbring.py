"""Klarbring's springs: one candidate and two displacements, where answers are one, several or none.

u = (u_t, u_n) along a plane and off it, gap u_n, slip u_t + s0 since the anchor, and with forces F::

    K_tt u_t + K_nt u_n = F_t + t,    K_nt u_t + K_nn u_n = F_n + f

An open candidate, one that sticks and one that slips to either side have two equations each, and every answer of those
that obeys its inequalities is one of the problem. Where mu |K_nt| < K_tt and K is definite there is one; beyond, a
sliding may drive itself, and there are up to three. A definite K always leaves one, an indefinite one may leave none.
Source: Klarbring, Ingenieur-Archiv 60 (1990) 529-541.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.catalogue import by_the_exact_law
from contact.coulomb import Coulomb, State
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, linear_mechanics
from studies.experiments import Row, tabulated

STIFF = 1e10  # MPa/mm, of regularised
SAME = 1e-7  # of the answer: springs give way by the inverse of their stiffness


def in_plane(
    contact: ContactProblem, along: sparse.csr_matrix, mu: float, start: np.ndarray | float = 0.0
) -> ContactProblem:
    """A plane problem with friction: slips start (m,) + along (m, n) u, and none in the second direction."""
    slips = sparse.csr_matrix(sparse.kron(along, [[1.0], [0.0]]))
    begun = np.zeros((len(contact.weights), 2))
    begun[:, 0] = start
    coefficients = np.full(len(contact.weights), mu)
    law = Coulomb(coefficients, lambda u: begun + (slips @ u).reshape(-1, 2), lambda u: slips)
    return replace(contact, coulomb=law)


@dataclass(frozen=True)
class Springs:
    """K_tt, K_nt, K_nn [N/mm], mu, forces F_t, F_n [N], and the slip s0 [mm] at u = 0."""

    tt: float
    nt: float
    nn: float
    mu: float
    along: float
    off: float
    slip0: float = 0.0

    @property
    def coupling(self) -> float:
        """mu |K_nt|/K_tt."""
        return self.mu * abs(self.nt) / self.tt

    @property
    def problem(self) -> ContactProblem:
        """The same for an algorithm; areas are 1."""
        K = sparse.csc_matrix([[self.tt, self.nt], [self.nt, self.nn]])
        G, along = sparse.csr_matrix([[0.0, 1.0]]), sparse.csr_matrix([[1.0, 0.0]])
        mechanics = linear_mechanics(K, np.array([self.along, self.off]))
        contact = ContactProblem(mechanics, lambda u: G @ u, lambda u: G, np.ones(1))
        return in_plane(contact, along, self.mu, self.slip0)


@dataclass(frozen=True)
class Answer:
    """State, u_t, u_n [mm], f, t [N]; word: what the candidate does, with the sense of a slip."""

    word: str
    u_t: float
    u_n: float
    f: float
    t: float


def answers(springs: Springs) -> list[Answer]:
    """All answers, case by case; raises ValueError where one of the cases has no or endless answers by itself."""
    k, possible = springs, list[Answer]()
    determinant = k.tt * k.nn - k.nt**2
    slopes = {sense: k.tt + sense * k.mu * k.nt for sense in (1.0, -1.0)}
    if determinant == 0 or 0.0 in slopes.values():
        raise ValueError("a case of these springs is singular")
    u_t, u_n = (k.nn * k.along - k.nt * k.off) / determinant, (k.tt * k.off - k.nt * k.along) / determinant
    if u_n > 0:
        possible.append(Answer("open", u_t, u_n, 0.0, 0.0))
    f, t = -k.nt * k.slip0 - k.off, -k.tt * k.slip0 - k.along
    if f >= 0 and abs(t) <= k.mu * f:
        possible.append(Answer("stick", -k.slip0, 0.0, f, t))
    for sense, slope in slopes.items():  # t = -sense mu f, f = K_nt u_t - F_n
        u_t = (k.along + sense * k.mu * k.off) / slope
        f = k.nt * u_t - k.off
        if f >= 0 and sense * (u_t + k.slip0) > 0:
            possible.append(Answer(f"slip {'+' if sense > 0 else '-'}", u_t, 0.0, f, -sense * k.mu * f))
    return possible


CASES: dict[str, Springs] = {  # K_tt, K_nt, K_nn, mu, F_t, F_n, s0
    "below the bound, open": Springs(1.0, -0.6, 1.0, 0.8, 0.3, 1.0),
    "below the bound, stick": Springs(1.0, -0.6, 1.0, 0.8, 0.2, -1.0),
    "below the bound, slip +": Springs(1.0, -0.6, 1.0, 0.8, 1.5, -1.0, -0.7),
    "below the bound, slip -": Springs(1.0, -0.6, 1.0, 0.8, -1.5, -1.0),
    "beyond it, open alone": Springs(1.0, -0.6, 1.0, 2.5, 4.0, -1.0),
    "beyond it, stick alone": Springs(1.0, -0.6, 1.0, 2.5, 0.3, -1.0),
    "beyond it, slip - alone": Springs(1.0, -0.6, 1.0, 1.8, -4.0, -1.0),
    "beyond it, slip - alone, pulled off": Springs(1.0, -0.9, 1.0, 1.8, -4.0, 1.0, 0.7),
    "beyond it, three": Springs(1.0, -0.6, 1.0, 1.8, 1.8, -1.0, 0.7),
    "beyond it, three, coupled more": Springs(1.0, -0.9, 1.0, 1.8, 1.5, -1.0),
    "indefinite, two: open, slip": Springs(1.0, -1.5, 1.0, 0.8, -4.0, -1.0, -0.7),
    "indefinite, two: stick, slip": Springs(1.0, -1.5, 1.0, 1.8, 1.5, -1.0),
    "indefinite, none, pulled off": Springs(1.0, -1.5, 1.0, 0.8, 0.3, 1.0, -0.7),
    "indefinite, none, pressed": Springs(1.0, -1.5, 1.0, 2.0, 2.5, -1.0),
}


def algorithms(stiffness: float) -> list[ContactAlgorithm]:
    """All of the catalogue, on springs of this stiffness [MPa/mm] where there are any, and the naive set."""
    return list(by_the_exact_law(stiffness, naive=True).values())


@tabulated
def klarbring_table() -> Iterator[Row]:
    """A row per case and algorithm: all answers there are, how the solve ended, and which answer it ended with.

    found: the answer, "" where none is claimed, "wrong" where one is claimed that is none.
    """
    for case, springs in CASES.items():
        there_are = answers(springs)
        for algorithm in algorithms(STIFF):
            solution = algorithm.solve(springs.problem, ContactSolution.at_rest(2, 1))
            row = {"case": case, "mu_Knt_over_Ktt": springs.coupling, "answers": len(there_are)}
            row |= {"which": ", ".join(answer.word for answer in there_are), "algorithm": algorithm.name}
            yield row | {"outcome": solution.outcome.word, "found": _found(solution, there_are)}


def _found(solution: ContactSolution, there_are: Sequence[Answer]) -> str:
    if not solution.outcome.converged:
        return ""
    values = np.array([*solution.u, solution.pressure[0], solution.rubbed.force[0, 0]])
    for answer in there_are:
        known = np.array([answer.u_t, answer.u_n, answer.f, answer.t])
        state = State[answer.word.split()[0].upper()]
        if solution.rubbed.state[0] == state and np.max(np.abs(values - known)) <= SAME * np.max(np.abs(known)):
            return answer.word
    return "wrong"
