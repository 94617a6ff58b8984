"""The exact measure on grids that grow: the limit that all else is compared with, and when its grids are enough."""

from __future__ import annotations

import math
from collections.abc import Callable

from studies.choosing.clock import Clock
from studies.choosing.ladder import FAILURES
from studies.choosing.rule import NONE, errors, first_enough
from studies.choosing.variants import REFERENCE
from studies.refinement.cascade import FINER, TOO_FINE, Cascade
from studies.refinement.limits import Estimate
from studies.refinement.nested import element_size, near
from studies.refinement.point_loads import HALVINGS, growth
from studies.request import Request, UsageError

DEARER = 2.8  # seconds of the next grid over those of the last, which has half the unknowns
NO_TIME = "no time for "
ENOUGH = 2  # grids that show what quantities there are


def follow(cascade: Cascade, request: Request, clock: Clock, progress: Callable[[str], None]) -> str:
    """Follow the path on finer and finer grids until one of them is enough; returns why there are no more of them.

    request: on the coarsest grid.  Raises UsageError for a quantity that the scene does not have.
    """
    grid: Request | None = request
    lost, said = 0, ""
    while grid is not None and lost < FAILURES:
        text = "{}x{}".format(*grid.mesh)
        if cascade.grids and not clock.fits(DEARER * cascade.last.seconds):
            return f"{NO_TIME}{text}"
        progress(f"{REFERENCE} {text}")
        said = f"the path is not followed to its end on {text}"
        followed = cascade.grow(grid)
        if not followed and not cascade.grids and element_size(grid) < TOO_FINE * element_size(request):
            break
        lost = lost + 1 if cascade.grids and not followed else 0
        if followed:
            said = ""
            _check_quantity(cascade)
            found = cascade.stated()
            if isinstance(found, Estimate):
                progress(f"{cascade.name} {found.limit:.6g} +- {100 * found.uncertainty:.2g} %")
                if first_enough(errors(_values(cascade), found), NONE, cascade.error) is not None:
                    return ""
        grid = near(cascade.scene, grid, FINER)
    return said


def limit_stated(cascade: Cascade) -> Estimate | str:
    """The limit of the exact measure, or why there is none to compare with."""
    if not cascade.grids:
        return f"the path of the measure {REFERENCE} is not followed to its end on any grid"
    name, limit, value = cascade.name, cascade.stated(), abs(_values(cascade)[-1])
    grows = growth(cascade.last, name)
    if HALVINGS * grows > cascade.error * value:
        grown = f"it grows by {100 * grows / value:.2g} % with every halving of the elements"
        return f"{name} has no limit in a theory with shear under a point load: {grown}"
    return f"the limit of {name} is not known: {limit}" if isinstance(limit, str) else limit


def _values(cascade: Cascade) -> list[float]:
    return [each.quantities.get(cascade.name, math.nan) for each in cascade.grids]


def _check_quantity(cascade: Cascade) -> None:
    """Raise UsageError where more grids than ENOUGH do not have the quantity."""
    if len(cascade.grids) > ENOUGH and not any(cascade.name in each.quantities for each in cascade.grids):
        has = ", ".join(cascade.last.quantities)
        raise UsageError(f"{cascade.scene.name} has no quantity {cascade.name!r}; it has {has}")
