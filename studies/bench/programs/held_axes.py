"""Our own solid under the rule that a deck puts on plies: in every brick one direction, that at its centre.

What it finds on the bricks of a deck, with Gauss points and shape functions of its own, shows how much of a difference
is the rule's. No other program enters here.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from formulations.solid import SolidDiscretisation, SolidModel
from studies.algorithm_settings import configured
from studies.complete import complete
from studies.exchange.problem import Problem
from studies.scenes import SCENES
from studies.scenes.tyre.solid import SolidTyreModel
from studies.scenes.tyre.wall import checked_wall
from studies.walk import walk

SOLID = "tyre-solid"
CENTRE = 13  # of the 27 Gauss points


def inflated_equator(problem: Problem, *, held: bool = True) -> float:
    """Radial growth [mm] of the outer face at the equator of the inflated solid on the bricks of a tyre.

    nan where the solid is not inflated.  held: whether axes are those at the centre; else those at each Gauss point.
    """
    n1, n2 = problem.request.mesh
    known = {setting.key for setting in SCENES[SOLID].settings}
    own = {key: value for key, value in problem.request.settings.items() if key in known and key != "solver"}
    scene, request = complete(SOLID, own, f"{n1}x{n2}", model=problem.request.model)
    model = scene.build(request)
    assert isinstance(model, SolidTyreModel)
    solid = model.body.discretisation
    if held:
        frame = np.repeat(solid.mesh.frame[:, CENTRE : CENTRE + 1], solid.mesh.frame.shape[1], axis=1)
        laminate = checked_wall(request.settings)[0]
        solid = SolidDiscretisation.build(replace(solid.mesh, frame=frame), laminate, solid.fixed)
        model = replace(model, body=SolidModel(solid, model.body.pressure))
    stages = (stage for stage in model.stages() if stage.name != "press")
    *_, last = walk(stages, configured(request.contact, request.settings), request.steps)
    rest, inflated = (model.wall.faces(u)[1][model.wall.crown, 0] for u in (np.zeros_like(last.state.u), last.state.u))
    return float(inflated - rest) if last.converged else np.nan
