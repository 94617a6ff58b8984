"""The judge: recomputes what an answer is worth from (problem, u, pressure) alone and trusts no algorithm.

What it excuses as rounding is its own to say: algorithms have theirs in :mod:`contact.rounding`.
What a wrong answer looks like it was spoilt by is told by :mod:`contact.diagnosis`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse

from contact.balances import BALANCE, energy_balance, force_balance, last_digits, pair_balance
from contact.problem import ContactProblem, Linearised
from contact.scales import Stiffness, length
from contact.solvers.sparse import SingularMatrixError, checked_solve, factorise

if TYPE_CHECKING:
    from contact.verify_friction import LawResiduals

KKT = ("equilibrium", "penetration", "tension", "complementarity")
EQUILIBRIUM = 1e-8
ROUNDING_ALONE = 1e-6  # relative residual up to which rounding is an excuse by itself
WORST_ROUNDING = 1e-2  # up to which it is one if it moves nothing, and beyond which it never is
SLIGHT = 1e-5  # forces of the foundation below this share of those in balance must be met themselves
NEGLIGIBLE = 1e-9  # of all displacement: what a residual may still ask for that moves nothing
GAP = 2e-12  # of a large gap: twice what an algorithm may leave
PAIR = 1e-12  # of the forces of two faces, and of these times their size
POSITION = 10 * float(np.finfo(float).eps)  # of where the foundation is: the rounding of a gap


@dataclass(frozen=True)
class Verdict:
    """Residuals of the contact conditions.

    equilibrium: |r - G^T W p| over the largest force in balance [-].  penetration: largest -g [mm].
    tension: largest -p [MPa].  complementarity: largest |p g| [MPa mm].  All are >= 0, best 0.
    rounding: the equilibrium that rounding alone would explain [-]; it excuses nothing above itself.
    correction: the displacement that the imbalance still asks for over all displacement [-], on the pressed nodes held
    at their gaps; infinite unless it decides, see :meth:`excused`.
    energy: mismatch of the work of all forces with the change of energy, over the largest part [-]; None without a
    potential.  force: |sum of the forces of the foundation + all others on the body| over the largest [-]; None where
    the problem does not tell the others.  energy_rounding, force_rounding: what rounding explains of each.
    pair_force, pair_moment: resultant and moment of what two faces do to each other, over their size [-]; None where
    there is a foundation, or planes of symmetry that carry all moments. They are those of rounding or wrong: no load
    excuses them.
    push: |G^T W p| over the largest force [-]; where it is slight, equilibrium is judged by it, see
    :meth:`needed`.
    length [mm], pressure [MPa]: a large gap, see :func:`contact.scales.length`, and the largest pressure. The bounds of
    penetration and complementarity are relative to them.  gap_rounding [mm]: of the position of the foundation.
    law: the residuals of friction, where there is some; tension and ``pressure`` are in N then, complementarity in
    N mm, and the balance of energy is that of work under the given friction.
    """

    equilibrium: float
    penetration: float
    tension: float
    complementarity: float
    rounding: float
    correction: float = np.inf
    energy: float | None = None
    force: float | None = None
    pair_force: float | None = None
    pair_moment: float | None = None
    energy_rounding: float = 0.0
    force_rounding: float = 0.0
    length: float = 0.0
    pressure: float = 0.0
    gap_rounding: float = 0.0
    push: float = 0.0
    law: LawResiduals | None = None

    @property
    def kkt(self) -> dict[str, float]:
        """The four residuals by name, and those of friction."""
        measured = {name: getattr(self, name) for name in KKT}
        return measured if self.law is None else {**measured, **self.law.by_name}

    @property
    def balances(self) -> dict[str, float]:
        """The balances of energy, of work with friction, of force and of a pair by name, those that can be told."""
        names = {"energy" if self.law is None else "work": self.energy, "force": self.force}
        names |= {"pair_force": self.pair_force, "pair_moment": self.pair_moment}
        return {name: balance for name, balance in names.items() if balance is not None}

    @property
    def certificate(self) -> dict[str, Any]:
        """What a result says of itself: {failures, kkt, balances, rounding, scales}; certified when nothing failed."""
        fields = {"failures": self.failures(), "kkt": self.kkt, "balances": self.balances, "rounding": self.rounding}
        if self.law is not None:
            return fields | {"scales": {"length_mm": self.law.length, "force_N": self.law.force}}
        return fields | {"scales": {"length_mm": self.length, "pressure_MPa": self.pressure}}

    def exceeded(
        self,
        *,
        equilibrium: float = EQUILIBRIUM,
        penetration: float = GAP,
        tension: float = 0.0,
        complementarity: float = GAP,
        balance: float = BALANCE,
    ) -> dict[str, tuple[float, float]]:
        """Size and bound of the residuals that are above theirs, by name (NaN counts as above).

        penetration, tension and complementarity are relative to the length, the pressure and their product. The
        defaults are those of an exact multiplier; a finite epsilon needs wider bounds for penetration, p/epsilon, and
        complementarity, p^2/epsilon, or an answer judged with its epsilon. ``balance`` bounds energy and force.
        """
        bounds = {
            "equilibrium": np.inf if self.excused else self.needed(equilibrium),
            "penetration": self.gap_bound(penetration),
            "tension": tension * self.pressure,
            "complementarity": self.gap_bound(complementarity) * self.pressure,
            "energy": max(balance, min(self.energy_rounding, ROUNDING_ALONE)),
            "work": max(balance, min(self.energy_rounding, ROUNDING_ALONE)),
            "force": max(balance, min(self.force_rounding, ROUNDING_ALONE)),
            "pair_force": PAIR,
            "pair_moment": PAIR,
        } | ({} if self.law is None else self.law.bounds)
        sizes = {**{name: getattr(self, name) for name in KKT}, **self.balances, **self.kkt}
        return {name: (size, bounds[name]) for name, size in sizes.items() if not size <= bounds[name]}

    @property
    def excused(self) -> bool:
        """Whether the imbalance is rounding and does not matter.

        In face displacements rounding makes pairs of forces across the thickness, of the size eps E l^2 |u|/h, that
        move nothing: a plate 300 times thinner than it is lifted keeps a residual of 1e-5, a strip twisted by 90
        degrees and 3,750 times as long as it is thick one of 6e-3; both are right to 1e-9 and better (measured).
        """
        harmless = self.equilibrium <= WORST_ROUNDING and self.correction <= NEGLIGIBLE
        return self.equilibrium <= self.rounding and (self.equilibrium <= ROUNDING_ALONE or harmless)

    def needed(self, tolerance: float) -> float:
        """The equilibrium that ``tolerance`` asks for, where the foundation's share of the forces is slight, too.

        A foundation that has only just come carries next to nothing of an inflated body: what balances to 1e-9 of all
        forces may have its force all wrong. So its share counts below SLIGHT, down to what is rounding.
        """
        slight = tolerance * min(1.0, self.push / SLIGHT) if self.push > 0 else tolerance
        return max(slight, min(self.rounding, tolerance))

    def failures(self, **bounds: float) -> list[str]:
        """The names of the residuals above their bounds, as :meth:`exceeded` takes them."""
        return list(self.exceeded(**bounds))

    def gap_bound(self, share: float = GAP) -> float:
        """Largest gap [mm] that counts as closed: a share of a large one, and the rounding of the foundation."""
        return share * self.length + self.gap_rounding


def claim(tolerance: float, n: int) -> dict[str, float]:
    """Bounds for :meth:`Verdict.exceeded` of an answer in n unknowns that claims equilibrium to ``tolerance``.

    The judge's own unless the tolerance is wider. A sum of n nodal imbalances is at most sqrt(n) times their norm.
    """
    if tolerance <= EQUILIBRIUM:
        return {}
    return {"equilibrium": tolerance, "balance": max(BALANCE, math.sqrt(n) * tolerance)}


def judge(
    problem: ContactProblem,
    u: np.ndarray,
    pressure: np.ndarray,
    friction: np.ndarray | None = None,
    *,
    epsilon: float = np.inf,
    since: np.ndarray | None = None,
) -> Verdict:
    """Recompute all residuals.

    Raises ValueError when the forces do not fit the candidates, or friction does not fit the problem.

    friction (m, 2) [N]: of a problem that has some.
    epsilon [MPa/mm]: with a finite one the conditions are those of its law, that is of the gap g + p/epsilon; with
    friction of springs in both directions.
    since (n,): state from which the energy is balanced, at the same loads; default the guide of the problem, or rest.
    With friction, the last accepted one.
    """
    if problem.coulomb is not None:
        return _with_friction(problem, u, pressure, friction, epsilon, since)
    if friction is not None:
        raise ValueError("friction is given of a problem that has none")
    if pressure.shape != problem.weights.shape:
        raise ValueError(f"{pressure.shape} pressures for {problem.weights.shape} contact candidates")
    if not np.all(np.isfinite(u)):
        return Verdict(np.nan, np.nan, np.nan, np.nan, rounding=0.0)  # no mechanics has an answer to it
    lin = problem.linearise(u, None)
    contact = problem.contact_force(u, pressure)
    forces = max(lin.scale, float(np.linalg.norm(contact)))
    scale, sprung = forces or 1.0, pressure / epsilon
    large = length(problem, Stiffness.of(problem, lin, u), u, forces)
    imbalance, rounding = lin.residual - contact, last_digits(lin, u, forces) / scale
    equilibrium = float(np.linalg.norm(imbalance)) / scale
    # excused or not by what it still asks for alone
    undecided = ROUNDING_ALONE < equilibrium <= min(rounding, WORST_ROUNDING)
    if since is None:
        since = np.zeros_like(u) if problem.guide is None else problem.guide
    energy, energy_rounding = energy_balance(problem, since, u, contact, lin)
    force, force_rounding = force_balance(problem, lin, u, pressure)
    gaps = gap_residuals(problem, u, pressure, epsilon)
    pair_force, pair_moment = pair_balance(problem, u, pressure)
    return Verdict(
        equilibrium=equilibrium,
        penetration=gaps["penetration"],
        complementarity=gaps["complementarity"],
        tension=float(np.max(-pressure, initial=0.0)),
        rounding=rounding,
        correction=_correction(problem, lin, u, pressure, epsilon) if undecided else np.inf,
        energy=energy,
        force=force,
        pair_force=pair_force,
        pair_moment=pair_moment,
        energy_rounding=energy_rounding,
        force_rounding=force_rounding,
        length=max(large, float(np.max(np.abs(sprung), initial=0.0))),
        pressure=float(np.max(np.abs(pressure), initial=0.0)),
        gap_rounding=POSITION * problem.gap_size,
        push=float(np.linalg.norm(contact)) / scale,
    )


def _with_friction(
    problem: ContactProblem,
    u: np.ndarray,
    pressure: np.ndarray,
    friction: np.ndarray | None,
    epsilon: float,
    since: np.ndarray | None,
) -> Verdict:
    """Of the contact under the given friction, and of the law."""
    from contact.verify_friction import Rubbed, residuals_of_law, under  # nothing without friction loads it

    law, m = problem.coulomb, len(problem.weights)
    assert law is not None
    if problem.unfit_for_friction:
        raise ValueError(problem.unfit_for_friction)
    if friction is None or pressure.shape != (m,) or friction.shape != (m, 2):
        shapes = f"{pressure.shape} and {None if friction is None else friction.shape}"
        raise ValueError(f"forces of shapes {shapes} for {m} contact candidates")
    w, normal = problem.weights, problem.nodal_forces(pressure)
    give = np.divide(1 / epsilon, w, out=np.zeros_like(w), where=w > 0)
    faces, sliding = problem.faces, law.sliding
    if faces is not None and sliding is not None:
        faces, law = Rubbed(faces, sliding, friction, give * normal), replace(law, slip=sliding.measured)
    sprung = replace(problem, gap=lambda u: problem.gap(u) + give * normal, faces=faces)
    verdict = judge(under(sprung, law, friction), u, normal, since=since)
    verdict = replace(verdict, length=max(verdict.length, float(np.max(give * np.abs(normal), initial=0.0))))
    opened = (normal <= 0) | (sprung.gap(u) > verdict.gap_bound())
    large, none = (verdict.length, verdict.pressure), (GAP, POSITION)
    return replace(verdict, law=residuals_of_law(law, u, (normal, friction), give, opened, large, none))


def gap_residuals(problem: ContactProblem, u: np.ndarray, pressure: np.ndarray, epsilon: float) -> dict[str, float]:
    """Penetration [mm] and complementarity [MPa mm] by the law of an epsilon [MPa/mm], that is of g + p/epsilon.

    The gaps of two faces are measured anew.
    """
    gap = problem.gap(u) if problem.faces is None else problem.faces.measured(u)
    gap = gap if np.isinf(epsilon) else gap + pressure / epsilon
    return {
        "penetration": float(np.max(-gap, initial=0.0)),
        "complementarity": float(np.max(np.abs(pressure * gap), initial=0.0)),
    }


def _correction(
    problem: ContactProblem,
    lin: Linearised,
    u: np.ndarray,
    pressure: np.ndarray,
    epsilon: float,
) -> float:
    """|du|/|u|: the displacement that the imbalance still asks for, on the pressed nodes held at their gaps.

    K du - G^T W dp = -(r - G^T W p),   G du + dp/epsilon = 0 on the nodes with p > 0;  ``lin``: at u, without memory.
    Infinite when that is singular.
    """
    nodes, G = np.flatnonzero(pressure > 0), problem.gap_jacobian(u)
    K = problem.stiffness(lin, u, pressure)
    above = sparse.hstack([K, -sparse.csc_matrix(G.T @ problem.weight_matrix)[:, nodes]])
    below = sparse.hstack([G[nodes], sparse.diags_array(np.full(len(nodes), 1 / epsilon), format="csr")])
    A = sparse.csc_matrix(sparse.vstack([above, below]))
    b = np.append(problem.contact_force(u, pressure) - lin.residual, np.zeros(len(nodes)))
    try:
        du = checked_solve(factorise(A), A, b)[: len(u)]
    except SingularMatrixError:
        return float("inf")
    return float(np.linalg.norm(du) / np.linalg.norm(u))
