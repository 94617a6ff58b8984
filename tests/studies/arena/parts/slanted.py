"""Bad on purpose: a measure that says it is exact, with a wrong coefficient."""

from formulations.strains.catalogue import EXACT_TERMS, MEASURES
from formulations.strains.measure import EXACT_LAW, quadratic_measure

SLANTED = quadratic_measure(
    "slanted",
    EXACT_TERMS | {"E11": {**EXACT_TERMS["E11"], "t1 t1": 0.45}},
    meaning="Green-Lagrange with a tenth of t1² missing",
    reference="made up",
    rigid_body_law=EXACT_LAW,
)
MEASURES[SLANTED.name] = SLANTED
