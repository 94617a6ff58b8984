"""Which scenes can be exported, and each as a problem in neutral terms.

The kind of a scene's model decides how: a shell under loads, one before a plane, a tyre, a ring as a solid. A new scene
of one of these kinds needs nothing here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.shell import ShellModel
from studies.ask.request import Request, UsageError
from studies.ask.scene import Scene, SceneModel
from studies.ask.settings import configured, rubbing
from studies.exchange.of_body import Body, of_shell, of_solid
from studies.exchange.problem import LoadStep, Plane, Problem, materials
from studies.scenes.complete import complete
from studies.scenes.contact import crushed_ring
from studies.scenes.contact.base import ContactModel
from studies.scenes.contact.crushed_ring_solid import SolidRingModel
from studies.scenes.plugins import built
from studies.scenes.statics import StaticModel
from studies.scenes.tyre.model import InflatedTyre, TyreModel, checked_wall
from studies.scenes.tyre.parts import mirrored
from studies.scenes.tyre.press import PressedTyre
from studies.scenes.tyre.solid import SolidTyreModel
from studies.scenes.walk import walk

CLEARANCE = 0.1  # of the growth of a tyre: how far the plane stays off while it is inflated, or shrinks
INFLATED = 4
MOST_THROUGH = 16
TURNED = ("half", "mirror", "sector")  # models of a part of a tyre with a seam that is not a plane of symmetry


def problem_of(
    name: str, given: Mapping[str, object], mesh: str | None = None, through: int = 1, **options: Any
) -> Problem:
    """The scene as a problem; raises UsageError for a request that is wrong or cannot be exported.

    given, mesh, options: as for :func:`studies.scenes.complete.complete`; mesh counts bricks.  through: bricks in each
    ply of a shell, from 1 to 16; a solid has its own setting.
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
    model = built(scene, request)
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
    raise UsageError(f"scene {name!r} cannot be exported: a deck has one body, under loads or on a plane")


def _of_shell(scene: Scene, request: Request, shell: ShellModel, through: int) -> tuple[Body[ShellModel], SceneModel]:
    """The body, and the model on the mesh twice as fine that loads are read from."""
    n1, n2 = request.mesh
    finer = scene.build(replace(request, mesh=(2 * n1, 2 * n2)))
    return of_shell(shell.discretisation, _shell(finer).discretisation, through), finer


def _shell(model: SceneModel) -> ShellModel:
    assert isinstance(model, StaticModel | ContactModel | TyreModel)
    return model.shell


def _under_loads(scene: Scene, request: Request, model: StaticModel, through: int) -> Problem:
    body, finer = _of_shell(scene, request, model.shell, through)
    shell = _shell(finer)
    steps = [LoadStep(f"load {t:g}", t, *body.loads(shell.scaled(t))) for t in model.fractions]
    return _problem(scene, request, "load_fraction", body, steps)


def _before_plane(scene: Scene, request: Request, model: ContactModel, through: int) -> Problem:
    body, finer = _of_shell(scene, request, model.shell, through)
    assert isinstance(finer, ContactModel)
    start, steps, fine = _plane(model.plane_at(0.0)), [], finer.body_at or finer.shell.scaled
    for t in model.targets:
        plane = _plane(model.plane_at(t))
        if not np.allclose(plane.normal, start.normal, atol=0, rtol=1e-12):
            raise UsageError(f"a plane that turns cannot be exported: that of {request.scene} does")
        steps.append(LoadStep(f"{model.key} {t:g}", t, *body.loads(fine(t)), plane.offset))
    return _problem(scene, request, model.key, body, steps, Plane(start.normal, start.offset))


def _tyre(scene: Scene, request: Request, model: TyreModel | SolidTyreModel, through: int) -> Problem:
    """Inflation with the plane out of reach, then its travel from where it touches first, by our own inflation.

    No travel at all is inflation alone, without a plane.
    """
    body: Body[Any]
    if isinstance(model, TyreModel):
        body, finer = _of_shell(scene, request, model.shell, through)
        loads = body.loads(_shell(finer))
    else:
        body = of_solid(model.body.discretisation, checked_wall(request.settings)[0])
        loads = body.loads(model.body)
    normal = _plane(model.foundation).normal
    fields: dict[str, Any] = {"crown": int(np.argmax(body.bricks.x @ normal)), "copies": model.wall.part.copies}
    if tuple(model.deltas) == (0.0,):
        return _problem(scene, request, "delta_mm", body, [LoadStep("inflation", 0.0, *loads)], **fields)
    rest, touched = _first_touch(scene, request, model, normal)
    start = max(rest, touched) + CLEARANCE * abs(touched - rest)
    steps = [LoadStep("inflation", None, *loads, start)]
    steps += [LoadStep(f"delta_mm {delta:g}", delta, *loads, touched - delta) for delta in model.deltas]
    return _problem(scene, request, "delta_mm", body, steps, Plane(normal, start), touched=touched, **fields)


def _ring(scene: Scene, request: Request, model: SolidRingModel) -> Problem:
    body = of_solid(model.body.discretisation, crushed_ring.ring(request)[1])
    loads, plane = body.loads(model.body), crushed_ring.plate(request, 0.0)
    steps = [
        LoadStep(f"delta_mm {delta:g}", delta, *loads, crushed_ring.plate(request, delta).offset)
        for delta in request.numbers("delta_mm")
    ]
    return _problem(scene, request, "delta_mm", body, steps, Plane(plane.normal, plane.offset))


def _problem(
    scene: Scene,
    request: Request,
    key: str,
    body: Body[Any],
    steps: Sequence[LoadStep],
    plane: Plane | None = None,
    **fields: Any,
) -> Problem:
    plies = materials(body.laminate)
    return Problem(
        request, scene.title, key, body.bricks, plies, body.supports, tuple(steps), plane, body.shell, **fields
    )


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
