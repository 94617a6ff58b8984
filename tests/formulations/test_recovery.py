"""What the strains of recovered displacements say of the error of an element."""

import numpy as np

from formulations.recovery import PARTS, energy_products
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell


def test_the_parts_of_an_element_make_its_area(rng) -> None:
    """A field that is the same in all parts has the energy of the element."""
    patch = next(iter(PATCHES.values()))
    shell = make_shell(patch.surface, patch.grid(2, 3))
    d, D = rng.normal(size=(6, 11)), SKEW_LAMINATE.stiffness(shell.section)
    found = energy_products(shell, *[np.repeat(d[:, None], PARTS, axis=1)] * 2)
    np.testing.assert_allclose(found, shell.discretisation.geometry.weight * np.einsum("ei,ij,ej->e", d, D, d))
