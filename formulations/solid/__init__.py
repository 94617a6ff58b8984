"""Bodies without kinematic assumption and their laws; no shell element and no contact may enter here."""

from formulations.solid.body import SolidDiscretisation as SolidDiscretisation
from formulations.solid.body import SolidModel as SolidModel
