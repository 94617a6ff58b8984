"""What the wall of a tyre is made of: plies, geometry, inflation, and the shell they make on a grid."""

from __future__ import annotations

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import torus
from formulations.loads.pressure import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.request import Request, Settings
from studies.ask.scene import UsageError
from studies.scenes.element import discretise
from studies.scenes.statics import loaded_shell
from studies.scenes.tyre.parts import Part

ORTHOTROPIC = {"E_L_MPa": 510.45, "E_T_MPa": 6.91, "G_LT_MPa": 2.33, "G_TT_MPa": 1.77, "nu_LT": 0.46, "nu_TT": 0.95}


def inflated_shell(request: Request, part: Part) -> ShellModel:
    """The shell on the grid of the part under the pressure inside."""
    settings = request.settings
    laminate, R1, R0, _ = checked_wall(settings)
    supports = Supports.of_edges(part.grid, *part.edges)
    discretisation = discretise(request, torus(R0 - R1, R1), part.grid, laminate, *supports.masks, images=part.images)
    return loaded_shell(discretisation, request, section=settings.choice("section"), pressure=inflation(settings))


def checked_wall(settings: Settings) -> tuple[Laminate, float, float, float]:
    """Laminate, R1, R0 [mm] and clamp [deg]; raises UsageError on impossible geometry or plies."""
    try:
        laminate = _laminate(settings)
    except ValueError as error:
        raise UsageError(str(error)) from None
    R1, R0, clamp = (settings.number(key) for key in ("R1_mm", "R0_mm", "clamp_deg"))
    if not laminate.thickness < R1:
        raise UsageError(
            f"thickness plies*ply_thickness_mm = {laminate.thickness:g} mm must be below R1_mm = {R1:g} mm"
        )
    if not R0 - R1 + (R1 + laminate.thickness) * np.cos(np.deg2rad(clamp)) > 0 or not R0 >= R1:
        raise UsageError(f"R0_mm = {R0:g} is too small: the wall at clamp_deg = {clamp:g} would cross the axis")
    return laminate, R1, R0, clamp


def inflation(settings: Settings) -> Pressure:
    """The pressure inside."""
    return Pressure(settings.number("p0_MPa"), settings["load"] == "follower", area=settings.choice("pressure_area"))


def _laminate(settings: Settings) -> Laminate:
    thickness, plies = settings.number("ply_thickness_mm"), int(settings.number("plies"))
    if "E_MPa" in settings:
        ply = Ply.isotropic(settings.number("E_MPa"), settings.number("nu"), thickness)
        return Laminate((ply,) * plies, d_minus=0.0)
    E_L, E_T, G_LT, G_TT, nu_LT, nu_TT = (settings.number(key) for key in ORTHOTROPIC)
    gamma = np.deg2rad(settings.number("gamma_deg"))
    angles = [(-1) ** k * gamma for k in range(plies)]
    return Laminate(tuple(Ply(E_L, E_T, G_LT, G_TT, nu_LT, nu_TT, a, thickness) for a in angles), d_minus=0.0)
