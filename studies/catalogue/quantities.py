"""What the quantities of the scenes mean, and where they are read; a name that is not here explains itself by its unit.

The scenes' own words come first: what a class or module says of a quantity stands on its sheet, too.
"""

from __future__ import annotations

from collections.abc import Mapping

UNITS = ("N_per_mm", "mm", "MPa", "deg", "N")
_TIP = "mean over both faces of the loaded edge"
ALL: Mapping[str, str] = {  # of any scene
    "force_N": "contact force, the sum of the nodal pressures times their areas",
    "contact_nodes": "nodes that touch",
    "limit_points": "limit points of the load on the curve",
    "limit_load_fraction": "load fraction at the first limit point",
    "load_limit_point": "load fraction at which the path ends at a limit point",
    "tip_shortening_mm": f"motion of the tip against a1, {_TIP}",
    "tip_deflection_mm": f"motion of the tip along the normal, {_TIP}",
    "stretch": "deformed over reference radius of the middle surface",
    "thickness_ratio": "deformed over reference thickness",
    "error_displacement": "relative L2 error of the displacements of both faces",
    "error_resultants": "relative error of the resultants in the elements",
    "error_mean_resultants": "relative error of the mean resultants of the elements",
    "error_energy": "relative error in the norm of energy",
    "error_pressure": "relative L2 error of the nodal contact pressures",
    "error_edge": "root mean square distance of the edge of contact from the exact one, over its radius",
    "error_area": "error of the area that touches, over the exact one",
}
OF_SCENE: Mapping[str, Mapping[str, str]] = {
    "tyre": {
        "centre_pressure_MPa": "contact pressure at the centre of the patch, psi = phi = 0",
        "half_length_mm": "from the centre of the patch to its rim around the axis, along the deformed outer face",
        "half_width_mm": "from the centre of the patch to its rim along the meridian, on the deformed outer face",
        "patch_to_clamp_mm": "from the rim of the patch to the nearest clamped edge, along the meridian",
        "inflated_equator_inner_mm": "radial displacement of the inner face at psi = 0 after inflation",
        "inflated_equator_outer_mm": "radial displacement of the outer face at psi = 0 after inflation",
    },
    "hemisphere": {
        "outward_mm": "outwards under the force that pulls, at a1 = a2 = 0, mean of both faces",
        "inward_mm": "inwards under the force that pushes, at a1 = 0, a2 = 90 degrees, mean of both faces",
    },
    "sze-annulus": {
        "w_A_mm": "across the plate at the inner corner of the loaded side, a1 = 6 mm, a2 = 0",
        "w_B_mm": "across the plate at the outer corner of the loaded side, a1 = 10 mm, a2 = 0",
    },
    "sze-pullout": {
        "w_A_mm": "outwards under the force, a1 = a2 = 0; grows by the logarithm of the size of the elements",
        "w_A_even_mm": "w_A without what elements of another size than the thickness add to it",
        "u_B_mm": "outwards at mid-length on the side, a1 = 0, a2 = 90 degrees",
        "u_C_mm": "outwards at the free end on the side, a1 = 5.175 mm, a2 = 90 degrees",
    },
    "sze-pinched": {
        "w_A_mm": "inwards under the force, a1 = a2 = 0",
        "u_B_mm": "outwards at mid-length on the side, a1 = 0, a2 = 90 degrees",
    },
    "semicylinder": {"w_A_mm": "inwards under the force, on the crown at the free end, a1 = 304.8 mm, a2 = 0"},
    "roof": {
        "w_C_mm": "downwards under the force, a1 = a2 = 0; grows by the logarithm of the size of the elements",
        "w_C_even_mm": "w_C without what elements of another size than the thickness add to it",
    },
    "shallow-cap": {"w_apex_mm": "downwards at the edge of the small hole at the apex"},
    "pressurised-torus": {
        "N_phi": "membrane resultant along the meridian, sum of both faces",
        "N_theta": "membrane resultant around the axis, sum of both faces",
    },
    "scordelis-lo": {"edge_deflection_mm": "downwards in the middle of the free edge, a1 = 25 mm, a2 = 40 degrees"},
    "pinched-cylinder": {"deflection_mm": "inwards under the force, a1 = a2 = 0"},
    "free-hyperboloid": {"w_waist_mm": "outwards at the waist, a1 = a2 = 0"},
    "pagano": {
        "w_bar": "100 E_T w/(q0 h S^4), w at the middle of the plate",
        "sigma_x_bar": "sigma_x/(q0 S^2) on the upper face at the middle of the plate",
        "tau_xz_bar": "tau_xz/(q0 S) in the middle plane at x = 0, y = b/2",
        "tau_yz_bar": "tau_yz/(q0 S) in the middle plane at x = a/2, y = 0",
    },
    "strip-contact": {
        "half_force": "contact force of the half strip over D g/a^3 of its width",
        "free_length": "from the clamp to the begin of contact, over the half span a",
        "edge_pressure": "contact pressure at the begin of contact over D g/a^4",
    },
    "heavy-strip": {
        "free_length": "from the lifted end to the begin of contact, over (D delta/q)^(1/4)",
        "lift_force": "force that lifts the end, over q (D delta/q)^(1/4) of the width",
    },
    "plate-contact": {
        "contact_force": "force on the plane over D g/a^2",
        "contact_radius": "radius of the disc of contact over that of the plate",
    },
    "ring": {
        "P_R2_over_EI": "force of a plate times R^2/(E I)",
        "P_H2_over_EI": "force of a plate times the square of the distance of the middle lines of contact, over E I",
        "flat_half_length": "centre of the nodal contact forces from the middle of the flat part, over R",
    },
    "panel": {"peak_MPa": "largest contact pressure at a node"},
    "crushed-ring": {
        "force_N": "contact force of half a plate",
        "least_stretch": "smallest principal stretch in the ring",
        "largest_stretch": "largest principal stretch in the ring",
    },
}
FAMILIES = ("semicylinder", "roof", "crushed-ring", "tyre")  # scenes whose names begin with it share its quantities


def definition(scene: str, quantity: str) -> str:
    """What a quantity is and where it is read; a value at a limit point says so."""
    of_limit = quantity.startswith("limit_") and quantity not in ALL
    bare = quantity.removeprefix("limit_") if of_limit else quantity
    family = next((name for name in FAMILIES if scene == name or scene.startswith(f"{name}-")), scene)
    own = {**ALL, **OF_SCENE.get(family, {})}
    said = next((text for name, text in own.items() if bare == name or bare.startswith(f"{name}_")), "")
    place = next((name for name in ("outer", "crown", "inner") if scene == "pressurised-torus" and name in bare), "")
    words = [
        said or "see the scene",
        *([f"at the {place} {'' if place == 'crown' else 'equator'}".strip()] if place else []),
    ]
    return ", ".join([*words, *(["at the first limit point"] if of_limit else [])])


def unit(quantity: str) -> str:
    """The unit that a name ends in; 1 for a number without one."""
    found = next((name for name in UNITS if quantity.endswith(f"_{name}")), "1")
    return found.replace("_per_", "/")
