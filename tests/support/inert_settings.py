"""Inputs that change nothing: every setting of a scene is moved, and what is built from it must move, too.

A setting that nobody reads looks like a study that was made: a public code tested friction with mu = 0 for years. No
problem is solved here. What a request builds is seen at made-up states: residual, tangent, gaps, weights, targets and
what is observed there; and the algorithm with its parameters, and the path. One bit that differs is an effect.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from types import MappingProxyType
from typing import Any

import numpy as np
import pandas as pd

from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution
from studies.ask.request import Request, Value
from studies.ask.scene import CurveStage, Scene, Setting, Stage, UsageError
from studies.ask.settings import configured, parameters_of
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.refinement.grids import coarsest_mesh
from studies.solving.solve import solve

NOISE = 1e-3  # mm, of the made-up displacements
FACTORS = (1.1, 0.9, 1.5, 0.5, 2.0)  # of a number, until one is in its range
FAR = (1e3, 1e-3, 1e6, 10.0, 0.1)  # of a parameter of an algorithm, which decides when to stop more than what is found
UNSET = (1.0, 2.0, 10.0, 0.5)  # tried where a scene works a number out
TRAVELS: dict[str, object] = {"delta_mm": 20.0}
BY_POINTS: tuple[dict[str, Any], ...] = ({"given": {"path": "arc-length"}},)
WAYS: dict[str, tuple[dict[str, Any], ...]] = {  # other ways than the defaults, in which more settings have a say
    **dict.fromkeys((*(f"roof-{letter}" for letter in "abcdef"), "shallow-cap", "sze-pullout"), BY_POINTS),
    "free-hyperboloid": ({"given": {"shear_correction": 1.0}},),
    "stack": ({"mesh": (1, 20)},),  # on coarser ones 0.75 and 0.825 of the elements are as many
    "half-spheres": ({"mesh": (20, 1)}, {"mesh": (20, 1), "given": {"bodies": "shells"}}),
    "ironing": ({"mesh": (1, 24)},),
    "face-patch": ({"mesh": (8, 8)}, {"given": {"mu": 0.3}}),  # on coarser ones 0.75 and 0.825 are as many, too
    "crossed-tubes": ({"given": {"layers": "many"}},),
    "ring-on-layer": ({"given": {"nu_layer": 0.3, "delta_mm": "1"}},),  # a contact that is small beside the ring
    **dict.fromkeys(  # on 14x14 0.75 and 0.825 of the elements are as many
        ("tyre-on-plate", "tyre-on-drum"), ({"mesh": (28, 14), "given": {"E_MPa": 20.0, "nu": 0.45}},)
    ),
    "panel": (
        {"mesh": (6, 6)},
        {"given": {"E_ratio": 10.0, "inflation": 1.0}},
        {"given": {"foundation": "ball"}},
    ),
    "tyre": (
        {"given": {"E_MPa": 20.0, "nu": 0.45}},
        {"given": {"E_MPa": 20.0, "nu": 0.45, "surfaces": "3"}},
        {"given": {"path": "arc"}},
        {"given": {"foundation": "drum"}},
        {"given": {"foundation": "cleat"}},
        {"model": "sector"},
    ),
    "tyre-solid": (
        {"given": {"E_L_MPa": 510.0, "plies": 2, "ply_thickness_mm": 2.4}},
        {"given": {"foundation": "drum"}},
        {"given": {"foundation": "cleat"}},
        {"given": {"E_MPa": 20.0, "nu": 0.45}},
    ),
}
MOVED: dict[str, Any] = {"given": {"element": "quads", "distort": 0.05}}

COLUMNS = ("scene", "setting", "value", "effect")
NONE, REFUSED, FAILS = "none", "refused", "fails"
MISSING = "not installed"  # nobody can say here
Print = dict[str, Any]  # what is seen, by where: arrays, numbers, words


def moved(setting: Setting, now: Value | None, factors: Sequence[float] = FACTORS) -> Iterator[object]:
    """Other values of a setting, to be tried in order; each word but the one it has."""
    if setting.kind == "choice":
        yield from (choice for choice in setting.choices if choice != (now or setting.otherwise))
        return
    if setting.kind == "floats":
        numbers = now if isinstance(now, tuple) else (1.0,)
        yield from ((*numbers[:-1], numbers[-1] * factor) for factor in factors)
        return
    if now is None or isinstance(now, str | tuple):
        yield from UNSET
    elif setting.kind == "int":  # a share in whole per cent is moved as a number is, for 1 % of few elements is none
        yield from (
            (round(now * factor) for factor in factors)
            if setting.unit == "%"
            else (now + step for step in (1, -1, 2, -2))
        )
    elif now == 0 or math.isinf(now):
        yield from UNSET
    else:
        yield from (now * factor for factor in factors)


def prints(scene: Scene, request: Request) -> Print:
    """What a request makes, seen by where: "problem", "observed", "path" and "algorithm"."""
    seen: Print = {"algorithm": repr(configured(request.contact, request.settings))}
    previous: ContactSolution | None = None
    for stage in scene.build(request).stages():
        problem_at, start = stage.begin(previous)
        n, m = len(start.u), len(start.pressure)
        rng = np.random.default_rng(n)
        guide = problem_at(stage.targets[-1]).guide
        u = start.u + NOISE * rng.standard_normal(n) + (0.0 if guide is None else guide)
        state = replace(start, u=u, pressure=rng.uniform(1.0, 2.0, m), active=np.ones(m, bool))
        targets = tuple(stage.targets)
        curve = stage.continuation if isinstance(stage, CurveStage) else None
        seen[f"path {stage.name}"] = (targets, request.steps, curve)
        problem = problem_at(targets[-1])
        seen[f"problem {stage.name}"] = _seen(problem, state, rng.standard_normal(n))
        seen[f"observed {stage.name}"] = _observed(stage, problem, state, targets[-1])
        previous = stage.lifted(state)
    return seen


def _seen(problem: ContactProblem, state: ContactSolution, along: np.ndarray) -> tuple[np.ndarray, ...]:
    """Residual, tangent, gaps with their slopes, weights: all that an algorithm is given."""
    lin, gap = problem.linearise(state.u, None), problem.gap_jacobian(state.u)
    weights = problem.weights if problem.coupling is None else problem.coupling @ problem.weights
    return lin.residual.copy(), lin.tangent @ along, problem.gap(state.u), gap @ along, weights


def _observed(stage: Stage, problem: ContactProblem, state: ContactSolution, target: float) -> object:
    """What is read off a state that is none: where that fails, the reason, for it is as good a sign."""
    try:
        actual = stage.observe(problem, state, target)
    except (ArithmeticError, ValueError) as error:
        return str(error)
    return repr(actual.step), repr(actual.quantities)


def effect(before: Print, after: Print) -> str:
    """The first place in which two prints differ, :data:`NONE` where they are the same to the bit."""
    if before.keys() != after.keys():
        return "stages"
    return next((place for place in before if not _same(before[place], after[place])), NONE)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, tuple) and isinstance(other, tuple) and any(isinstance(part, np.ndarray) for part in one):
        return len(one) == len(other) and all(map(_same, one, other))
    return bool(one == other)


def effects(
    name: str,
    given: Mapping[str, object] | None = None,
    mesh: tuple[int, int] | None = None,
    only: Sequence[str] = (),
    **options: Any,
) -> pd.DataFrame:
    """A row for each setting of a scene, or for ``only`` some of them, and each word it may be: COLUMNS.

    given: other settings than the defaults, which may wake one up; mesh: by default the coarsest of the scene.  effect:
    where it shows first; "none"; "refused" where no value that was tried is a request, with the reason.
    """
    mesh = mesh or coarsest_mesh(SCENES[name])
    scene, request = complete(name, given or {}, mesh, **options)
    before = prints(scene, request)

    def tried(key: str, value: object) -> str:
        try:
            return effect(before, prints(*complete(name, {**(given or {}), key: value}, mesh, **options)))
        except UsageError as error:
            return MISSING if "needs the extra" in str(error) else f"{REFUSED}: {error}"
        except (ArithmeticError, ValueError, LookupError) as error:
            return f"{FAILS}: {type(error).__name__}: {error}"

    rows: list[tuple[str, str, object, str]] = []
    for setting in scene.settings:
        if setting.presets or (only and setting.key not in only):  # a name of others is resolved away
            continue
        actual = ((name, setting.key, value, tried(setting.key, value)) for value in _others(setting, request))
        if setting.kind == "choice":
            rows += actual
        else:
            rows.append(_first_accepted(actual))
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _others(setting: Setting, request: Request) -> Iterator[object]:
    return moved(setting, request.settings.get(setting.key))


def _first_accepted(rows: Iterator[tuple[str, str, object, str]]) -> tuple[str, str, object, str]:
    """Of values to be tried in order; the first one of all where every one is refused."""
    first = next(rows)
    return next((row for row in chain([first], rows) if not row[-1].startswith(REFUSED)), first)


def inert_settings(names: Iterable[str] = tuple(SCENES)) -> pd.DataFrame:
    """The settings and words that have no effect in any of the ways in which a scene is used: COLUMNS.

    A word counts by itself, a number whichever value it was given. What is refused everywhere is listed, and what fails
    anywhere with another error than one for people.
    """
    values = []
    for name in names:
        rows = pd.concat([effects(name, **way) for way in ({}, *WAYS.get(name, ()))], ignore_index=True)
        if rows["setting"].eq("distort").any():
            rows = pd.concat([rows, effects(name, only=("distort", "distortion"), **MOVED)])
        if rows["setting"].eq("surfaces").any():
            corrected = rows["setting"].eq("shear_correction").any()  # which two faces alone have
            with suppress(UsageError):  # of a wall that has two faces alone
                given = {"surfaces": "3", **({"shear_correction": 1.0} if corrected else {})}
                rows = pd.concat([rows, effects(name, given, only=("law",))])
        if rows["setting"].eq("bending").any():  # with directors at the nodes
            rows = pd.concat([rows, effects(name, {"thickness_strain": "nodal"}, only=("bending",))])
        word = rows["value"].where(rows["value"].map(lambda value: isinstance(value, str)), "")
        for _, own in rows.groupby([rows["setting"], word], sort=False):
            broken = own[own["effect"].str.startswith(FAILS)]
            if len(broken) or own["effect"].str.startswith((NONE, REFUSED)).all():
                values.append((broken if len(broken) else own).iloc[0])
    return pd.DataFrame(values, columns=list(COLUMNS)).reset_index(drop=True)


def algorithm_effects(
    scene: str = "tyre", mesh: tuple[int, int] = (12, 10), given: Mapping[str, object] = MappingProxyType(TRAVELS)
) -> pd.DataFrame:
    """What the parameters of the algorithms change in a solve, a row for each value: contact, setting, value, effect.

    effect: "result" of the quantities, "work" of the counters or the history, "none", or the reason of a refusal.
    """
    rows = []
    for contact in ALGORITHMS:
        before = _run(scene, mesh, given, contact)
        for setting in parameters_of(contact):
            for value in moved(setting, setting.default, FAR):
                try:
                    actual = effect(before, _run(scene, mesh, {**given, setting.key: value}, contact))
                except UsageError as error:
                    actual = f"{REFUSED}: {error}"
                rows.append((contact, setting.key, value, actual))
                if setting.kind != "choice" and not actual.startswith((NONE, REFUSED)):
                    break
    return pd.DataFrame(rows, columns=["contact", "setting", "value", "effect"])


def _run(scene: str, mesh: tuple[int, int], given: Mapping[str, object], contact: str) -> Print:
    result = solve(*complete(scene, given, mesh, contact=contact))
    history = [{key: value for key, value in row.items() if key != "event"} for row in result.history]
    work = repr(result.counters), repr(history)
    return {"result": (result.verdict, repr(result.quantities)), "work": work}
