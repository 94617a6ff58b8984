"""What a finite regularisation costs and gives: p = epsilon <-g> from far too soft to far too hard, in two forms.

Both solve the same equations. ``multiplier`` keeps the pressure as an unknown, G du + p/epsilon = -g, so that epsilon
may grow without bound. ``displacement`` eliminates it, K + epsilon G^T W G, as the paper does and as every penalty
method does: the matrix loses its condition, and the pressure, epsilon times a gap, the digits of the gap.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, onenormest

from contact.algorithms.semismooth import Semismooth
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import ContactProblem, ContactSolution, Linearised, Outcome
from contact.solvers.sparse import SingularMatrixError, checked_solve, factorise, superlu
from studies.experiments import Row, tabulated
from studies.scenes.complete import Cell, complete
from studies.scenes.contact import plate, strip
from studies.scenes.walk import walk

EPSILONS = tuple(10.0**k for k in range(-2, 15))  # MPa/mm
MOST_ITERATIONS = 60
STEADY = 8  # iterations on one contact set after which what is left is rounding
FORMS = ("multiplier", "displacement")


def _tyre(label: str, n: int = 20, settings: Mapping[str, str] | None = None) -> Cell:
    given = {"delta_mm": "20", "element": "paper"} | dict(settings or {})
    return Cell(label, "tyre", {"mesh": f"{n}x{n}", "measure": "exact", "model": "full"}, given)


def _beam(label: str, scene: str, n: int) -> Cell:
    return Cell(label, scene, {"mesh": f"{n}x1", "measure": "linear"}, {"load_fraction": "5"})


_RUBBER = {"delta_mm": "10", "nu": "0.45"}
CASES = (  # problems at the end of a path; walls of other moduli and thicknesses, and other elements
    _tyre("tyre"),
    _beam("strip", "strip-contact", 64),
    _tyre("tyre, coarse", 10),
    _tyre("rubber tyre", settings={"E_MPa": "20", **_RUBBER}),
    _tyre("rubber tyre, thin", settings={"E_MPa": "20", "ply_thickness_mm": "0.3", **_RUBBER}),
    _tyre("isotropic tyre, stiff", settings={"E_MPa": "2000", **_RUBBER}),
    _beam("strip, coarse", "strip-contact", 16),
    _beam("plate", "plate-contact", 16),
)


def wall(case: Cell) -> tuple[float, float, float]:
    """Largest modulus [MPa], thickness [mm] and shortest mean side of an element [mm] of a case."""
    request = complete(case.scene, case.settings, **case.options)[1]
    first = request.mesh[0]
    if case.scene != "tyre":
        of = {"strip-contact": strip, "plate-contact": plate}[case.scene]
        return of.E, of.H, of.A / first
    modulus = next(request.number(name) for name in ("E_MPa", "E_L_MPa") if name in request.settings)
    thickness = request.number("plies") * request.number("ply_thickness_mm")
    meridian = 2 * np.deg2rad(request.number("clamp_deg")) * (request.number("R1_mm") + thickness / 2)
    return modulus, thickness, float(meridian) / first


@tabulated
def epsilon_study(cases: Sequence[Cell] = CASES, epsilons: Sequence[float] = EPSILONS) -> Iterator[Row]:
    """One row for each case, form and epsilon; every solve starts from the state before contact.

    penetration_mm: the largest.  force_error: relative to the exact multiplier's sum of nodal forces.  nodes_unlike:
    contact nodes in only one of the two sets.  condition: 1-norm estimate of the matrix of the last iteration, with
    epsilon inf the saddle-point one.  outcome: of the solve; its numbers are those of the last iterate, whatever it is.
    command: solves the same case with the multiplier form, whose answer it is.
    """
    for case in cases:
        problem, start = before_contact(case)
        exact = _solved(problem, start, np.inf)
        if not exact.outcome.converged:
            raise RuntimeError(f"{case.label}: the exact multiplier did not converge: {exact.outcome.value}")
        for epsilon in (*epsilons, np.inf):
            for form in FORMS if np.isfinite(epsilon) else FORMS[:1]:
                solve = _solved if form == "multiplier" else by_displacements
                solution = solve(problem, start, epsilon)
                numbers = _measured(problem, exact, solution, form, epsilon)
                row = {"case": case.label, "form": form, "epsilon": epsilon} | numbers
                yield row | {"mesh": case.options["mesh"], "command": command(case, epsilon)}


def command(case: Cell, epsilon: float) -> str:
    """Solves a case with this epsilon, from the beginning of its path."""
    settings = {**case.settings, "epsilon": f"{epsilon:g}"}
    return replace(case, settings=settings).command


def _solved(problem: ContactProblem, start: ContactSolution, epsilon: float) -> ContactSolution:
    """With a linearisation for every set, so that the last step is small, and so is what rounding makes of it."""
    return Semismooth(epsilon, settle=1.0, max_iterations=MOST_ITERATIONS).solve(problem, start)


def before_contact(case: Cell) -> tuple[ContactProblem, ContactSolution]:
    """The last problem of the scene's last stage and the state that stage begins with."""
    scene, request = complete(case.scene, case.settings, **case.options)
    *before, last = scene.build(request).stages()
    visited = list(walk(before, Semismooth()))
    problem_at, start = last.begin(visited[-1].state if visited else None)
    return problem_at(last.targets[-1]), start


def by_displacements(problem: ContactProblem, start: ContactSolution, epsilon: float) -> ContactSolution:
    """Newton on r(u) = G^T W epsilon <-g>, the set following the sign of the gap; no safeguard against rounding."""
    u, memory, before, steady = start.u, None, start.active, 0
    for iteration in range(MOST_ITERATIONS + 1):
        lin, gap = problem.linearise(u, memory), problem.gap(u)
        active = gap < 0
        pressure = np.where(active, -epsilon * gap, 0.0)
        contact = problem.contact_force(u, pressure)
        scale = max(lin.scale, float(np.linalg.norm(contact)))
        outcome, counts = Outcome.CONVERGED, {"newton_iterations": float(iteration)}
        if np.linalg.norm(lin.residual - contact) <= RESIDUAL_TOLERANCE * scale:
            return ContactSolution(u, pressure, active, outcome, counts)
        steady, before = steady + 1 if np.array_equal(active, before) else 0, active
        if steady > STEADY:
            return ContactSolution(u, pressure, active, Outcome.ROUNDING, counts)
        if iteration == MOST_ITERATIONS:
            break
        try:
            A = penalised(problem, lin, u, active, epsilon)
            du = checked_solve(factorise(A), A, contact - lin.residual)
        except SingularMatrixError:
            return ContactSolution(u, pressure, active, Outcome.SINGULAR, counts)
        u, memory = u + du, lin.remember(du)
    return ContactSolution(u, pressure, active, Outcome.ITERATION_LIMIT, counts)


def penalised(
    problem: ContactProblem, lin: Linearised, u: np.ndarray, active: np.ndarray, epsilon: float
) -> sparse.csc_matrix:
    """K + epsilon G_A^T W G_A (n, n)."""
    G = problem.gap_jacobian(u)[np.flatnonzero(active)]
    return sparse.csc_matrix(lin.tangent + epsilon * (G.T @ sparse.diags_array(problem.weights[active]) @ G))


def saddle(
    problem: ContactProblem, lin: Linearised, u: np.ndarray, active: np.ndarray, epsilon: float
) -> sparse.csc_matrix:
    """[[K, G_A^T s], [s G_A, -s^2/(epsilon W)]]: the unknowns beside du are nodal forces over s.

    s = min(k, sqrt(epsilon W k)), k the mean diagonal of K, so that the last block is never larger than K.
    """
    G, k = problem.gap_jacobian(u)[np.flatnonzero(active)], float(np.mean(np.abs(lin.tangent.diagonal())))
    stiffness = epsilon * problem.weights[active]
    s = np.minimum(k, np.sqrt(stiffness * k))
    softness, scaled = sparse.diags_array(-(s**2) / stiffness), sparse.diags_array(s) @ G
    above, below = sparse.hstack([lin.tangent, scaled.T]), sparse.hstack([scaled, softness])
    return sparse.csc_matrix(sparse.vstack([above, below]))


def condition(A: sparse.csc_matrix) -> float:
    """|A| |A^-1| in the 1-norm, infinite for a singular matrix; the second factor is an estimate from below.

    Higham, ACM Trans. Math. Softw. 14 (1988) 381: with one column (t = 1) nothing in it is random.
    """
    n = A.shape[0]
    try:
        factor = superlu(A)
    except SingularMatrixError:
        return float("inf")
    back = partial(factor.solve, trans="T")
    inverse = LinearOperator((n, n), matvec=factor.solve, rmatvec=back, dtype=np.dtype(float))
    return float(sparse.linalg.norm(A, 1) * onenormest(inverse, t=1))


def _measured(
    problem: ContactProblem, exact: ContactSolution, solution: ContactSolution, form: str, epsilon: float
) -> Row:
    lin = problem.linearise(solution.u, None)
    matrix = (saddle if form == "multiplier" else penalised)(problem, lin, solution.u, solution.active, epsilon)
    force, wanted = (float(problem.nodal_forces(state.pressure).sum()) for state in (solution, exact))
    return {
        "outcome": solution.outcome.word,
        "iterations": int(solution.counters["newton_iterations"]),
        "penetration_mm": float(np.max(-problem.gap(solution.u), initial=0.0)),
        "force_N": force,
        "force_error": force / wanted - 1,
        "nodes_unlike": int(np.sum(solution.active != exact.active)),
        "condition": condition(matrix),
    }
