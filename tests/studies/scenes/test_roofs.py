"""Hinged roofs of Sze against published curves and the 3D solid, on three meshes and extrapolated; their files."""

import json
from functools import cache, partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy import sparse
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from contact.continuation.arc_length import ArcLength
from contact.problem import Outcome
from formulations.geometry.surfaces import cylinder
from formulations.shell import Linearisation
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.cli import NOT_CONVERGED, main
from studies.scenes import SCENES
from studies.scenes.benchmarks.snapping import HALF_ANGLE, HALF_LENGTH, P_MAX, RADIUS, Roof, published_limit
from studies.scenes.complete import complete as resolve
from studies.scenes.data import read_reference
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.solved import distances, extrapolated

ROOF = 1e-2  # of the load at a limit point
CURVE = 1.2e-2  # largest distance of a published point from our curve, in units of the ranges of load and displacement


@cache
def run(scene: str, mesh: str, steps: int, path: str = "series") -> Result:
    """A tenth beyond the published load."""
    given = {"thickness_strain": "nodal", "membrane": "compatible", "load_fraction": "1.1", "path": path}
    result = solve(*resolve(scene, given, mesh, steps=steps))
    assert result.outcome is Outcome.CONVERGED, result.reason
    for step in result.steps:
        assert step["kkt"]["equilibrium"] <= max(1e-9, step["rounding"])
    return result


def fitted_limit(sizes: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Order p and limit of values = limit + C size^p on three meshes."""

    def mismatch(p: float) -> float:
        a, b, c = sizes**p
        return float((values[0] - values[1]) * (b - c) - (values[1] - values[2]) * (a - b))

    order = float(brentq(mismatch, 0.5, 8.0))
    C = (values[1] - values[2]) / (sizes[1] ** order - sizes[2] ** order)
    return order, float(values[2] - C * sizes[2] ** order)


# --- a curve on its way to the files ----------------------------------------------------------------------------------


ROOF_A = [
    "solve",
    "roof-a",
    "--mesh",
    "4x4",
    "--set",
    "thickness_strain=nodal",
    "--set",
    "membrane=compatible",
    "--out",
]


def test_a_curve_that_does_not_arrive_is_written_and_exits_3(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("studies.scenes.curves.ArcLength", partial(ArcLength, max_points=3))
    assert main([*ROOF_A, str(tmp_path), "--set", "path=arc-length"]) == NOT_CONVERGED
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["outcome"] == "iteration-limit"
    assert "3 points" in result["reason"]
    assert len(result["steps"]) == 3


@pytest.mark.slow
def test_a_curve_is_written_point_by_point(tmp_path: Path) -> None:
    assert main([*ROOF_A, str(tmp_path)]) == 0
    result = json.loads((tmp_path / "result.json").read_text())
    curve = pd.read_csv(tmp_path / "curve.csv")
    assert {"load_fraction", "w_C_mm", "newton_iterations", "limit_point"} <= set(curve)
    assert len(curve) > 5 * len(result["steps"])  # drawn from the curve itself
    assert set(result["steps"][0]["kkt"]) == {"equilibrium", "penetration", "tension", "complementarity"}
    first = curve[curve["limit_point"] == 1].iloc[0]
    assert first["load_fraction"] == pytest.approx(result["quantities"]["limit_load_fraction"])
    assert first["w_C_mm"] == pytest.approx(result["quantities"]["limit_w_C_mm"])
    assert curve["limit_point"].sum() == result["quantities"]["limit_points"] == 2
    assert result["quantities"]["w_C_mm"] == curve["w_C_mm"].iloc[-1]


@pytest.mark.slow
def test_a_curve_that_ends_with_its_limit_point_has_the_same_one() -> None:
    whole, part = (solve(*resolve("roof-a", {"until": until}, "4x4")) for until in ("load", "limit"))
    assert part.outcome is Outcome.CONVERGED
    assert part.quantities["limit_points"] == 1
    for key in ("limit_load_fraction", "limit_w_C_mm", "limit_w_C_even_mm"):
        assert part.quantities[key] == pytest.approx(whole.quantities[key], rel=1e-9)
    assert part.counters["factorisations"] < 0.6 * whole.counters["factorisations"]


@pytest.mark.parametrize("lines", ["even", "edges"])
def test_even_deflection_is_without_the_logarithm_of_the_element_size(lines: str) -> None:
    """F/(2 pi G h) ln(h/l), F of the whole roof and l the mean side of the element under it."""
    actual = solve(*resolve("roof-a", {"until": "limit", "lines": lines}, "4x4")).quantities
    h, G = 12.7, 3102.75 / 2.6
    sides = np.array([HALF_LENGTH, RADIUS * HALF_ANGLE]) * (0.25 if lines == "even" else np.sin(np.pi / 8))
    rise = actual["limit_load_fraction"] * P_MAX / (2 * np.pi * G * h) * np.log(h / np.sqrt(sides.prod()))
    assert actual["limit_w_C_mm"] - actual["limit_w_C_even_mm"] == pytest.approx(rise, rel=1e-2)


# --- limit points and curves ------------------------------------------------------------------------------------------

ROOFS = ("roof-a", "roof-b", "roof-c", "roof-d", "roof-e", "roof-f")
QUICK = ("roof-d",)  # thin and layered; the others take up to a minute
LIMIT = "limit_load_fraction"
MESHES = ("8x8", "12x12", "16x16")

each_roof = pytest.mark.parametrize(
    "scene", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in ROOFS]
)


def published(scene: str) -> np.ndarray:
    roof = SCENES[scene]
    assert isinstance(roof, Roof)
    return read_reference(roof.data).to_numpy()


def limit_of(scene: str, kind: str) -> float:
    return next(r.value for r in SCENES[scene].references if (r.kind, r.quantity) == (kind, LIMIT))


def curve(scene: str, mesh: str, steps: int = 1) -> np.ndarray:
    """Load fraction and displacement (n, 2), from rest."""
    points = run(scene, mesh, steps).table("curve").columns
    return np.insert(np.stack([points["load_fraction"], points["w_C_mm"]], axis=1), 0, 0.0, axis=0)


def limits(scene: str) -> tuple[np.ndarray, float]:
    """First limit loads on the three meshes, and extrapolated from the finer two."""
    actual = np.array([run(scene, mesh, 1).quantities[LIMIT] for mesh in MESHES])
    return actual, float(extrapolated(actual[1], actual[2], 4 / 3))


@pytest.mark.slow
@pytest.mark.parametrize("scene", ROOFS)
def test_limit_load_converges_to_that_of_the_solid(scene: str) -> None:
    """Strains linear between the faces cost 0.3 to 0.5 % at 12.7 mm (of the order h^2), next to nothing at 6.35 mm."""
    actual, limit = limits(scene)
    error = limit / limit_of(scene, "computed") - 1
    if scene in ("roof-a", "roof-b", "roof-c"):
        assert -5e-3 <= error <= -2e-3
    else:
        assert abs(error) <= 2e-3
    assert abs(actual[2] - limit) < abs(actual[0] - limit)
    assert abs(actual[2] / limit - 1) <= ROOF
    for mesh in MESHES:
        number = run(scene, mesh, 1).quantities["limit_points"]
        assert number == (4 if scene == "roof-e" else 2)


@pytest.mark.parametrize("scene", [pytest.param(name, marks=pytest.mark.slow) for name in ROOFS if name != "roof-e"])
def test_limit_load_is_the_published_one_to_one_per_cent(scene: str) -> None:
    """Those of the thick roofs are 1.0 to 1.3 % above ours, with the solid between: they are 0.6 to 0.9 % above it.

    S4R is printed for one mesh; this shell is 0.3 to 0.5 % below the solid, see above.
    """
    read, solid, limit = limit_of(scene, "read"), limit_of(scene, "computed"), limits(scene)[1]
    if scene in ("roof-d", "roof-f"):
        assert limit == pytest.approx(read, rel=ROOF)
    else:
        assert ROOF < read / limit - 1 <= 1.3e-2
        assert 5e-3 <= read / solid - 1 <= ROOF


@pytest.mark.slow
def test_published_limit_of_the_sparsest_table_is_that_of_its_interpolation() -> None:
    """Ours at the three displacements of the printed curve of roof-e, interpolated as those: both 1.7 % too high."""
    table = published("roof-e")
    table = table[: np.argmax(np.diff(table[:, 0]) < 0) + 2]
    load, w = curve("roof-e", "16x16", steps=4).T
    rising = np.argmax(np.diff(w) <= 0)  # the displacement turns back later
    ours = CubicSpline(w[:rising], load[:rising])(table[:, 1])
    assert ours[1:] == pytest.approx(table[1:, 0], rel=ROOF)
    interpolated, _ = published_limit(np.stack([ours, table[:, 1]], axis=1))
    assert interpolated == pytest.approx(limit_of("roof-e", "read"), rel=ROOF)
    assert 1.5e-2 <= interpolated / np.max(load[:rising]) - 1 <= 3e-2


@pytest.mark.slow
@each_roof
def test_every_published_point_lies_on_our_curve(scene: str) -> None:
    table, ours = published(scene), curve(scene, "16x16")
    distance = distances(table / np.ptp(table, axis=0), ours / np.ptp(table, axis=0))
    assert np.max(distance) <= CURVE
    assert np.sqrt(np.mean(distance**2)) <= CURVE / 2


@pytest.mark.slow
def test_limit_point_does_not_depend_on_the_steps() -> None:
    one, four = (run("roof-d", "8x8", steps, "arc-length").quantities for steps in (1, 4))
    for quantity in (LIMIT, "limit_w_C_mm", "w_C_mm"):
        assert four[quantity] == pytest.approx(one[quantity], rel=1e-4)


class SolidRoof:
    """A quarter roof of triquadratic hexahedra; at the hinge every normal stays straight and turns about its middle."""

    def __init__(self, roof: Roof, n: int) -> None:
        lines = np.linspace(0, HALF_LENGTH, n + 1), np.linspace(0, HALF_ANGLE, n + 1)
        self.laminate = roof.laminate()
        self.mesh = SolidMesh.build(cylinder(RADIUS), *lines, self.laminate)
        height = self.mesh.parameter[:, 2]
        fixed = np.zeros((len(height), 3), bool)
        fixed[self.mesh.on(0, 0.0), 2] = fixed[self.mesh.on(1, 0.0), 1] = True
        edge = self.mesh.on(1, HALF_ANGLE)
        fixed[edge[np.abs(height[edge]) < 1e-9]] = True
        self.model = SolidModel(SolidDiscretisation.build(self.mesh, self.laminate, fixed))
        self.T = self._tie(edge, height)
        centre = np.intersect1d(self.mesh.on(0, 0.0), self.mesh.on(1, 0.0))
        forces = np.zeros((len(height), 3))
        forces[centre, 0] = -P_MAX / 4 / len(centre)
        self.load = self.T.T @ forces.ravel()[self.model.discretisation.free]

    def _tie(self, edge: np.ndarray, height: np.ndarray) -> sparse.csr_matrix:
        """u(z) = z/(h/2) u(h/2) on the edge: the unknowns of the model from the remaining ones."""
        top = height[edge].max()
        masters = {round(self.mesh.parameter[node, 0], 6): node for node in edge[np.isclose(height[edge], top)]}
        tie = sparse.lil_matrix((3 * len(height), 3 * len(height)))
        tie.setdiag(1.0)
        for node in edge[~np.isclose(height[edge], top)]:
            master = masters[round(self.mesh.parameter[node, 0], 6)]
            for x in range(3):
                tie[3 * node + x, 3 * node + x] = 0.0
                tie[3 * node + x, 3 * master + x] = height[node] / top
        rows = sparse.csc_matrix(tie)[self.model.discretisation.free]
        return sparse.csr_matrix(rows[:, np.flatnonzero(np.diff(rows.indptr))])

    def linearise(self, u: np.ndarray, memory: object) -> Linearisation:
        lin = self.model.linearise(self.T @ u)
        K = sparse.csc_matrix(self.T.T @ lin.tangent @ self.T)
        return Linearisation(self.T.T @ lin.residual, K, lin.scale, lambda du: None)


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "meshes"), [("roof-c", (4, 6, 8)), ("roof-d", (6, 8, 12))])
def test_solid_roofs_converge_to_the_computed_limits(scene: str, meshes: tuple[int, ...]) -> None:
    """Extrapolated by the order of the three meshes: a point load costs the quadratic hexahedra half of theirs."""
    roof, actual = SCENES[scene], []
    assert isinstance(roof, Roof)
    for n in meshes:
        solid = SolidRoof(roof, n)
        trace = ArcLength(0.05 if roof.thickness > 10 else 0.02, max_points=6).trace(
            solid.linearise, solid.load, (1.0,)
        )
        actual.append(next(point.factor for point in trace.points if point.limit))
    order, limit = fitted_limit(1 / np.array(meshes), np.array(actual))
    assert 2 <= order <= 4
    assert limit == pytest.approx(limit_of(scene, "computed"), rel=1e-3)
