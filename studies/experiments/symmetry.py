"""Symmetry and invariance: every measure by every algorithm where nothing must change, and what changes all the same.

Each check compares two answers that ought to be one, or an answer with its own image. A deviation is the largest
difference of pressures over the peak, or of displacements over the largest, whichever is more, and belongs to one of
five classes: exactly zero; what rounding explains; what the tolerance of the solver allows; broken by design, when the
measure or the structure declares that it must be; and broken by accident, which is a failure. What is declared to be
broken and is not is an accident, too, and so is a state that the judge of contact does not certify.

How far the pressure under a tyre is from its mirror image is swept over the cord angle: zero at 0 and 90 degrees only.
Plies at +-gamma have no mirror plane, but a half turn about the normal, so both mirrors are off alike. Near 0 and 90
degrees the inflated tyre is not stable: its tangent has negative eigenvalues before anything touches it, and which of
several states a solver then finds is a matter of its steps. Such angles are told by their number of negative
eigenvalues. The maximum is searched for in one dimension among the stable ones, around the largest value on the grid.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.continuation.spectrum import negative_eigenvalues
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.newton.step import ROUNDING_MARGIN
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.rounding import rounding_floor
from contact.verify import judge
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import StrainMeasure
from studies.ask.settings import configured
from studies.experiments import Row, tabulated
from studies.experiments.conformance import NOTICED, claims_objectivity
from studies.experiments.rigid_body import rotation
from studies.experiments.specimens import CYLINDER, FIRST, PLATE, TORUS, Element, Motion, Posed, Seen, Way, renumbered
from studies.scenes.complete import Cell, complete
from studies.scenes.tyre.model import TyreModel
from studies.scenes.tyre.parts import settle_model
from studies.scenes.tyre.readings import central_asymmetry, mirror_asymmetry
from studies.scenes.tyre.scene import Tyre
from studies.scenes.walk import Visited, walk

EXACT, ROUNDING, TOLERANCE = "exactly zero", "rounding", "solver tolerance"
DESIGN, ACCIDENT, REFUSED = "broken by design", "broken by accident", "does not apply"
THETA = 0.3  # rad, of rigid rotations
OBLIQUE = Motion(rotation(np.array([1.0, 2.0, -0.5]) / math.sqrt(5.25), THETA), np.array([0.3, -2.0, 1.0]))
ABOUT_Z = Motion(rotation(np.array([0.0, 0.0, 1.0]), THETA), np.array([0.0, 0.0, 0.4]))
SPLIT = 3  # load steps instead of one
TYRE_MESH, TYRE_TRAVEL, TYRE_ANGLES = "12x16", 8.0, (0.0, 52.0, 90.0)
SEED = 2004
WAYS = {  # of the torus, beside the first
    "axes exchanged": Way(swapped=True),
    "lengths over 1e6, stresses times 1e6": Way(length=1e-6, stress=1e6),
    "lengths times 1e6, stresses over 1e6": Way(length=1e6, stress=1e-6),
}


@dataclass(frozen=True, eq=False)
class Answer:
    """A state as it is compared: what it shows, whether it may be trusted, and what its own precision is.

    wrong: why it is not an answer, or nothing.  rounding, tolerance: relative deviations that machine precision and the
    residual tolerance of the solver, allow a nodal pressure.
    """

    seen: Seen
    wrong: str
    refused: bool
    rounding: float
    tolerance: float
    iterations: int


@tabulated
def symmetry_table(
    measures: Mapping[str, StrainMeasure] = MEASURES,
    algorithms: Mapping[str, Callable[[], ContactAlgorithm]] = ALGORITHMS,
) -> Iterator[Row]:
    """All checks of all pairs, one row each: deviation, its two yardsticks, its class, and why where one is due."""
    for name, measure in measures.items():
        inflated = {gamma: _inflated(measure, gamma) for gamma in TYRE_ANGLES}
        for algorithm_name, make in algorithms.items():
            algorithm = make()
            checks = [*_panels(measure, algorithm), *_tyres(inflated, algorithm)]
            yield from ({"measure": name, "algorithm": algorithm_name, **check} for check in checks)


def classified(deviation: float, rounding: float, tolerance: float, by_design: str = "") -> str:
    """The class of a deviation; ``by_design``: why it must be there, if it must."""
    if by_design:
        return DESIGN if deviation > max(NOTICED, tolerance) else ACCIDENT
    if deviation == 0:
        return EXACT
    if deviation <= rounding:
        return ROUNDING
    return TOLERANCE if deviation <= tolerance else ACCIDENT  # NaN is an accident


def against(check: str, one: Answer, other: Answer, by_design: str = "", deviation: float | None = None) -> Row:
    """The row of a check, its yardstick ``one``; deviation: by default, how far the answers are apart."""
    deviation = difference(one.seen, other.seen) if deviation is None else deviation
    wrong = one.wrong or other.wrong
    verdict, reason = classified(deviation, one.rounding, one.tolerance, by_design), by_design
    if wrong:
        verdict, reason = REFUSED if one.refused or other.refused else ACCIDENT, wrong
    elif verdict == ACCIDENT:
        reason = f"declared to be broken, and is not: {by_design}" if by_design else "nothing explains it"
    return {
        "check": check,
        "deviation": deviation,
        "rounding": one.rounding,
        "tolerance": one.tolerance,
        "class": verdict,
        "reason": reason,
        "iterations": one.iterations,
        "iterations_other": other.iterations,
    }


def difference(one: Seen, other: Seen) -> float:
    """The larger of the two relative differences; NaN without contact."""
    pressure = np.max(np.abs(one.pressure - other.pressure)) / (np.max(one.pressure) or math.nan)
    return float(max(pressure, np.max(np.abs(one.moved - other.moved)) / np.max(np.abs(one.moved))))


def _answer(
    problem: ContactProblem,
    state: ContactSolution,
    outcome: Outcome,
    algorithm: ContactAlgorithm,
    seen: Callable[[ContactSolution], Seen],
) -> Answer:
    """A state before the judge, and what to expect of its last digits."""
    refused = algorithm.supports(problem) or (outcome.value if outcome is Outcome.REFUSED else "")
    lin = problem.linearise(state.u, None)
    peak = float(np.max(state.pressure, initial=0.0))
    failures = judge(problem, state.u, state.pressure, epsilon=algorithm.epsilon).failures()
    wrong = "" if not failures else f"the judge finds {', '.join(failures)}"
    wrong = refused or (wrong if outcome.converged else outcome.value)
    force = float(np.min(problem.weights)) * peak or math.nan
    rounding = ROUNDING_MARGIN * rounding_floor(lin, state.u, lin.scale) / force
    tolerance = RESIDUAL_TOLERANCE * lin.scale / force
    spent = int(state.counters.get("newton_iterations", 0))
    return Answer(seen(state), wrong, bool(refused), rounding, tolerance, spent)


def _panels(measure: StrainMeasure, algorithm: ContactAlgorithm) -> Iterator[Row]:
    """A torus posed in other ways, and panels moved as a whole, together with all that holds and presses them."""
    first = TORUS.posed(measure)
    one = solved(first, algorithm)
    yield against("solved a second time", one, solved(first, algorithm))
    for check, way in WAYS.items():
        yield against(check, one, solved(TORUS.posed(measure, way), algorithm))
    yield against("nodes renumbered", one, solved(renumbered(first, np.random.default_rng(SEED)), algorithm))
    yield against(f"{SPLIT} load steps for one", one, solved(first, algorithm, SPLIT))
    for check, panel, motion, why in (
        ("plate moved and turned", PLATE, OBLIQUE, _turned_plate(measure)),
        ("cylinder turned about its axis", CYLINDER, ABOUT_Z, _turned_cylinder(measure)),
        ("torus moved and turned", ISOPARAMETRIC, OBLIQUE, _turned_plate(measure)),
    ):
        if not panel.element.suits(measure):
            continue
        still, moved = (solved(panel.posed(measure, way), algorithm) for way in (FIRST, Way(motion=motion)))
        yield against(check, still, moved, why)


ISOPARAMETRIC = replace(TORUS, element=Element("isoparametric"))


def solved(posed: Posed, algorithm: ContactAlgorithm, steps: int = 1) -> Answer:
    """The answer of an algorithm to a problem as it is posed."""
    own, problem = posed.algorithm(algorithm), posed.problem_at(1.0)
    state, outcome = posed.solved(algorithm, steps)
    return _answer(problem, state, outcome, own, posed.seen)


def _turned_plate(measure: StrainMeasure) -> str:
    """Why a turn must be noticed: the laws of the measure on a plate."""
    if claims_objectivity(measure):
        return ""
    law = measure.rigid_body_law
    out, drill = law.out_of_plane(THETA, 1.0), law.drilling(THETA, 1.0)
    return f"declares E11 = {out:.3g} of a plate turned by {THETA:g} rad out of its plane, {drill:.3g} within it"


def _turned_cylinder(measure: StrainMeasure) -> str:
    """Why a turn about the axis must be noticed: the law on the outer face of the panel."""
    strain = measure.rigid_body_law.axis(THETA, 1 + CYLINDER.outer_curvature)
    return f"declares E22 = {strain:.3g} on the face of a cylinder turned by {THETA:g} rad" if strain else ""


def _inflated(measure: StrainMeasure, gamma: float) -> tuple[TyreModel, Visited]:
    """A whole tyre at one cord angle, inflated by a measure."""
    settings = {"gamma_deg": f"{gamma:g}", "delta_mm": f"{TYRE_TRAVEL:g}", "element": "paper"}
    _, request = complete("tyre", settings, TYRE_MESH, model="full")
    model = TyreModel.on(request, *Tyre().lines(request))
    shell = replace(model.shell, measure=measure)
    model = replace(model, shell=shell, body=shell)
    inflation, _ = model.stages()
    *_, last = walk([inflation], Semismooth())
    return model, last


def _tyres(tyres: Mapping[float, tuple[TyreModel, Visited]], algorithm: ContactAlgorithm) -> Iterator[Row]:
    """The pressure of a whole tyre against its images: a turn by 180 degrees about the normal, and two mirrors."""
    for gamma, (model, inflated) in tyres.items():
        _, press = model.stages()
        *_, last = walk([press], algorithm, previous=inflated.state)

        def seen(state: ContactSolution, model: TyreModel = model) -> Seen:
            return Seen(np.zeros((2, 0, 3)), model.wall.spread(state.pressure))

        outcome = last.point.outcome if inflated.converged else inflated.point.outcome
        answer = _answer(last.problem, last.state, outcome, algorithm, seen)
        p = answer.seen.pressure.reshape(model.wall.part.shape)
        peak = float(np.max(p)) or math.nan
        what = f"cords at {gamma:g} deg"
        yield against(f"tyre turned about its normal, {what}", answer, answer, "", central_asymmetry(p) / peak)
        why = "" if gamma in (0.0, 90.0) else settle_model("auto", {"gamma_deg": gamma})[1]
        yield against(f"tyre mirrored, {what}", answer, answer, why, mirror_asymmetry(p) / peak)


NEAR = 1.0  # deg, how near the search comes to the angle of the maximum
MIRROR_MESH = "42x40"
ANGLES = (0.0, 2.0, 5.0, *range(10, 50, 5), 52.0, *range(55, 90, 5), 88.0, 90.0)


def mirrored(gamma: float, kind: str) -> Row:
    """The paper's tyre at a cord angle [deg]: the largest difference of the pressure from its mirror image.

    mirror_both_MPa: over pairs of nodes that both touch.  central_MPa: from the image under the half turn.
    """
    settings = {"gamma_deg": f"{gamma:.6g}", "delta_mm": "10,20", "element": "paper"}
    cell = Cell("", "tyre", {"measure": "exact", "mesh": MIRROR_MESH, "model": "half"}, settings)
    _, request = complete(cell.scene, cell.settings, **cell.options)
    row = {"measure": "exact", "mesh": MIRROR_MESH, "gamma_deg": gamma, "kind": kind, "command": cell.command}
    model = Tyre().build(request)
    *_, last = walk(model.stages(), configured(request.contact, request.settings), request.steps)
    if not last.converged:
        return row | {"outcome": last.point.outcome.word}
    state = last.state
    own, touching = (model.wall.spread(v).reshape(model.wall.part.shape) for v in (state.pressure, state.active))
    row |= {"outcome": "converged", "negative": negative_eigenvalues(last.problem, state, np.inf)}
    row |= {"peak_MPa": float(own.max()), "mirror_both_MPa": mirror_asymmetry(own, touching)}
    return row | {"central_MPa": central_asymmetry(own)}


def mirror_table() -> pd.DataFrame:
    """One row an angle: those of ANGLES, then those of the search for the largest ``mirror_both_MPa``.

    It is Brent's, between the neighbours of the largest value of a stable state at ANGLES.
    """
    rows = [mirrored(gamma, "grid") for gamma in ANGLES]
    value = np.array([_stable_value(row) for row in rows])
    if value.any():
        top = int(np.argmax(value))
        low, high = (ANGLES[min(max(i, 0), len(ANGLES) - 1)] for i in (top - 1, top + 1))

        def asymmetry(gamma: float) -> float:
            rows.append(mirrored(float(gamma), "search"))
            return -_stable_value(rows[-1])

        minimize_scalar(asymmetry, bounds=(low, high), method="bounded", options={"xatol": NEAR})
    return pd.DataFrame(rows).sort_values("gamma_deg", kind="stable", ignore_index=True)


def _stable_value(row: Row) -> float:
    """The asymmetry of a row, 0 where its state is none or is not stable."""
    return float(row["mirror_both_MPa"]) if row.get("negative") == 0 else 0.0
