"""Klarbring's springs: one candidate and two displacements, where answers are one, several or none.

u = (u_t, u_n) along a plane and off it, gap u_n, slip u_t + s0 since the anchor, and with forces F::

    K_tt u_t + K_nt u_n = F_t + t,    K_nt u_t + K_nn u_n = F_n + f

An open candidate, one that sticks and one that slips to either side have two equations each, and every answer of those
that obeys its inequalities is one of the problem. Where mu |K_nt| < K_tt and K is definite there is one; beyond, a
sliding may drive itself, and there are up to three. A definite K always leaves one, an indefinite one may leave none.
Source: Klarbring, Ingenieur-Archiv 60 (1990) 529-541.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import sparse

from contact.catalogue import by_the_exact_law
from contact.coulomb import Coulomb, State
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, linear_mechanics

STIFF = 1e10  # MPa/mm, of regularised
SAME = 1e-7  # of the answer: springs give way by the inverse of their stiffness


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
        G, S = sparse.csr_matrix([[0.0, 1.0]]), sparse.csr_matrix([[1.0, 0.0], [0.0, 0.0]])
        mechanics = linear_mechanics(K, np.array([self.along, self.off]))
        moved = np.array([[self.slip0, 0.0]])
        law = Coulomb(np.full(1, self.mu), lambda u: moved + (S @ u).reshape(1, 2), lambda u: S)
        return ContactProblem(mechanics, lambda u: G @ u, lambda u: G, np.ones(1), coulomb=law)


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
    k, found = springs, list[Answer]()
    determinant = k.tt * k.nn - k.nt**2
    slopes = {sense: k.tt + sense * k.mu * k.nt for sense in (1.0, -1.0)}
    if determinant == 0 or 0.0 in slopes.values():
        raise ValueError("a case of these springs is singular")
    u_t, u_n = (k.nn * k.along - k.nt * k.off) / determinant, (k.tt * k.off - k.nt * k.along) / determinant
    if u_n > 0:
        found.append(Answer("open", u_t, u_n, 0.0, 0.0))
    f, t = -k.nt * k.slip0 - k.off, -k.tt * k.slip0 - k.along
    if f >= 0 and abs(t) <= k.mu * f:
        found.append(Answer("stick", -k.slip0, 0.0, f, t))
    for sense, slope in slopes.items():  # t = -sense mu f, f = K_nt u_t - F_n
        u_t = (k.along + sense * k.mu * k.off) / slope
        f = k.nt * u_t - k.off
        if f >= 0 and sense * (u_t + k.slip0) > 0:
            found.append(Answer(f"slip {'+' if sense > 0 else '-'}", u_t, 0.0, f, -sense * k.mu * f))
    return found


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


def algorithms() -> list[ContactAlgorithm]:
    """All of the catalogue, on springs as stiff as they need be where there are any."""
    return list(by_the_exact_law(STIFF).values())


def klarbring_table(cases: Sequence[str] = tuple(CASES)) -> pd.DataFrame:
    """A row per case and algorithm: all answers there are, how the solve ended, and which answer it ended with.

    found: the answer, "" where none is claimed, "wrong" where one is claimed that is none.
    """
    rows = []
    for case in cases:
        springs, there_are = CASES[case], answers(CASES[case])
        for algorithm in algorithms():
            solution = algorithm.solve(springs.problem, ContactSolution.at_rest(2, 1))
            row = {"case": case, "mu_Knt_over_Ktt": springs.coupling, "answers": len(there_are)}
            row |= {"which": ", ".join(answer.word for answer in there_are), "algorithm": algorithm.name}
            rows.append(row | {"outcome": solution.outcome.word, "found": _found(solution, there_are)})
    return pd.DataFrame(rows)


def _found(solution: ContactSolution, there_are: Sequence[Answer]) -> str:
    if not solution.outcome.converged:
        return ""
    told = np.array([*solution.u, solution.pressure[0], solution.rubbed.force[0, 0]])
    for answer in there_are:
        known = np.array([answer.u_t, answer.u_n, answer.f, answer.t])
        state = State[answer.word.split()[0].upper()]
        if solution.rubbed.state[0] == state and np.max(np.abs(told - known)) <= SAME * np.max(np.abs(known)):
            return answer.word
    return "wrong"
