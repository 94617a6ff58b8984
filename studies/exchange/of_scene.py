"""Which scenes can be exported, and each as a problem in neutral terms.

The kind of a scene's model decides how: a shell under loads, one before a plane, a tyre, a ring as a solid. A new scene
of one of these kinds needs nothing here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.section.laminate import Laminate
from formulations.shell import ShellModel
from formulations.solid import SolidModel
from studies.algorithm_settings import configured
from studies.complete import complete
from studies.exchange import of_body
from studies.exchange.bricks import Bricks
from studies.exchange.problem import LoadStep, Plane, Problem, Supports, materials
from studies.friction.settings import rubbing
from studies.request import Request, UsageError
from studies.scene import Scene, SceneModel
from studies.scenes.contact import crushed_ring
from studies.scenes.contact.base import ContactModel
from studies.scenes.contact.crushed_ring_solid import SolidRingModel
from studies.scenes.statics import StaticModel
from studies.scenes.tyre.model import InflatedTyre, TyreModel
from studies.scenes.tyre.parts import mirrored
from studies.scenes.tyre.press import PressedTyre
from studies.scenes.tyre.solid import SolidTyreModel
from studies.scenes.tyre.wall import checked_wall
from studies.walk import walk

CLEARANCE = 0.1  # of the growth of a tyre: how far the plane stays off while it is inflated, or shrinks
INFLATED = 4
MOST_THROUGH = 16
TURNED = ("half", "mirror", "sector")  # models of a part of a tyre with a seam that is no plane of symmetry


@dataclass(frozen=True, eq=False)
class Body:
    """Bricks and their supports, and what makes loads of a model of the same scene."""

    bricks: Bricks
    supports: Supports
    laminate: Laminate
    shell: np.ndarray | None


def problem_of(
    name: str, given: Mapping[str, object], mesh: str | None = None, through: int = 1, **options: Any
) -> Problem:
    """The scene as a problem; raises UsageError for a request that is wrong or cannot be exported.

    given, mesh, options: as for :func:`studies.complete.complete`; mesh counts bricks.  through: bricks in each ply of
    a shell, from 1 to 16; a solid has its own setting.
    """
    if not 1 <= through <= MOST_THROUGH:
        raise UsageError(f"through = {through} must be a whole number in [1, {MOST_THROUGH}]")
    scene, request = complete(name, given, mesh, **options)
    if rubbing(request.settings):
        raise UsageError(f"mu = {request.number('mu'):g}: a problem with friction cannot be exported")
    if request.model in TURNED:
        request = replace(request, model="full", model_reason="a part that turns into the whole has no plane to cut at")
    if request.model == "axisymmetric":
        part = "quarter" if mirrored(request.settings) else "full"
        request = replace(request, model=part, model_reason="a column between two planes does not stay between them")
    model = scene.build(request)
    if isinstance(model, SolidTyreModel | SolidRingModel) and through != 1:
        raise UsageError(f"through = {through} does not apply to {name}, a solid has bricks of its own: set per_ply")
    if isinstance(model, StaticModel):
        return _under_loads(scene, request, model, through)
    if isinstance(model, ContactModel):
        return _before_plane(scene, request, model, through)
    if isinstance(model, TyreModel | SolidTyreModel):
        return _tyre(scene, request, model, through)
    if isinstance(model, SolidRingModel):
        return _ring(scene, request, model)
    raise UsageError(f"scene {name!r} cannot be exported: its loads or its model are none that a deck has")


def _of_shell(scene: Scene, request: Request, shell: ShellModel, through: int) -> tuple[Body, SceneModel]:
    """The body, and the model on the mesh twice as fine that loads are read from."""
    n1, n2 = request.mesh
    finer = scene.build(replace(request, mesh=(2 * n1, 2 * n2)))
    fine, body = _shell(finer).discretisation, shell.discretisation
    bricks = of_body.bricks_of_shell(body, through)
    supports = of_body.supports_of_shell(fine, body, bricks)
    return Body(bricks, supports, body.laminate, of_body.shell_nodes(body, bricks)), finer


def _shell(model: SceneModel) -> ShellModel:
    assert isinstance(model, StaticModel | ContactModel | TyreModel)
    return model.shell


def _under_loads(scene: Scene, request: Request, model: StaticModel, through: int) -> Problem:
    body, finer = _of_shell(scene, request, model.shell, through)
    steps = []
    for fraction in model.fractions:
        loads = of_body.loads_of_shell(_shell(finer).scaled(fraction), model.shell.discretisation, body.bricks)
        steps.append(LoadStep(f"load {fraction:g}", fraction, *loads))
    return _problem(scene, request, "load_fraction", body, tuple(steps))


def _before_plane(scene: Scene, request: Request, model: ContactModel, through: int) -> Problem:
    body, finer = _of_shell(scene, request, model.shell, through)
    assert isinstance(finer, ContactModel)
    start, steps = _plane(model.plane_at(0.0)), []
    for t in model.targets:
        plane = _plane(model.plane_at(t))
        if not np.allclose(plane.normal, start.normal, atol=0, rtol=1e-12):
            raise UsageError(f"a plane that turns cannot be exported: that of {request.scene} does")
        loads = of_body.loads_of_shell(
            (finer.body_at or finer.shell.scaled)(t), model.shell.discretisation, body.bricks
        )
        steps.append(LoadStep(f"{model.key} {t:g}", t, *loads, plane.offset))
    return _problem(scene, request, model.key, body, tuple(steps), Plane(start.normal, start.offset))


def _tyre(scene: Scene, request: Request, model: TyreModel | SolidTyreModel, through: int) -> Problem:
    """Inflation with the plane out of reach, then its travel from where it touches first, by our own inflation.

    No travel at all is inflation alone, without a plane.
    """
    if isinstance(model, TyreModel):
        body, finer = _of_shell(scene, request, model.shell, through)
        loads = of_body.loads_of_shell(_shell(finer), model.shell.discretisation, body.bricks)
    else:
        body = _of_solid(model.body, checked_wall(request.settings)[0])
        loads = of_body.loads_of_solid(model.body, body.bricks)
    normal = _plane(model.foundation).normal
    crown, copies = int(np.argmax(body.bricks.x @ normal)), model.wall.part.copies
    if tuple(model.deltas) == (0.0,):
        alone = (LoadStep("inflation", 0.0, *loads),)
        return _problem(scene, request, "delta_mm", body, alone, crown=crown, copies=copies)
    rest, touched = _first_touch(scene, request, model, normal)
    start = max(rest, touched) + CLEARANCE * abs(touched - rest)
    steps = [LoadStep("inflation", None, *loads, start)]
    steps += [LoadStep(f"delta_mm {delta:g}", delta, *loads, touched - delta) for delta in model.deltas]
    told = {"touched": touched, "crown": crown, "copies": copies}
    return _problem(scene, request, "delta_mm", body, tuple(steps), Plane(normal, start), **told)


def _ring(scene: Scene, request: Request, model: SolidRingModel) -> Problem:
    body = _of_solid(model.body, crushed_ring.ring(request)[1])
    loads, plane = of_body.loads_of_solid(model.body, body.bricks), crushed_ring.plate(request, 0.0)
    steps = [
        LoadStep(f"delta_mm {delta:g}", delta, *loads, crushed_ring.plate(request, delta).offset)
        for delta in request.numbers("delta_mm")
    ]
    return _problem(scene, request, "delta_mm", body, tuple(steps), Plane(plane.normal, plane.offset))


def _of_solid(body: SolidModel, laminate: Laminate) -> Body:
    bricks = of_body.bricks_of_solid(body.discretisation)
    return Body(bricks, of_body.supports_of_solid(body.discretisation, bricks), laminate, None)


def _problem(
    scene: Scene,
    request: Request,
    key: str,
    body: Body,
    steps: tuple[LoadStep, ...],
    plane: Plane | None = None,
    **told: Any,
) -> Problem:
    plies = materials(body.laminate)
    return Problem(request, scene.title, key, body.bricks, plies, body.supports, steps, plane, body.shell, **told)


def _plane(foundation: object) -> RigidPlane:
    if not isinstance(foundation, RigidPlane):
        raise UsageError(f"a foundation {type(foundation).__name__.lower()!r} cannot be exported: it must be a plane")
    return foundation


def _first_touch(
    scene: Scene, request: Request, model: TyreModel | SolidTyreModel, normal: np.ndarray
) -> tuple[float, float]:
    """n.x of the outermost point [mm] at rest and inflated, by our own solution.

    A shell is inflated on a grid INFLATED as fine, which costs a column of elements. Raises UsageError where the
    inflated state is not reached.
    """
    tyre: PressedTyre = model
    if isinstance(model, TyreModel):
        n1, n2 = (INFLATED * n for n in request.mesh)
        settings = request.settings.with_values(delta_mm=(0.0,))
        alone = scene.build(replace(request, mesh=(n1, n2), model="axisymmetric", settings=settings))
        assert isinstance(alone, InflatedTyre)
        tyre = alone
    stages = (stage for stage in tyre.stages() if stage.name != "press")
    *_, last = walk(stages, configured(request.contact, request.settings), request.steps)
    if not last.converged:
        raise UsageError(f"the tyre is not inflated, so the plane has no place to start from: {last.said}")
    faces = (tyre.wall.faces(u)[1] for u in (np.zeros_like(last.state.u), last.state.u))
    rest, inflated = (float(np.max(face @ normal)) for face in faces)
    return rest, inflated
