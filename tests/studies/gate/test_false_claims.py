"""Planted false claims: each is refused and named, the other cells are taken; an honest store is taken in whole."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studies.gate.merge import UNVERIFIED, VERIFIED, Summary, merge
from studies.run.archive import Archive
from support.stores.elsewhere import BEAM, CAP, FAILS, FINE, LINEAR, LOOSE, STRIP, TYRE, Elsewhere

Plant = Callable[[Elsewhere], object]


def scaled(label: str, share: float) -> Plant:
    return lambda there: there.bend(label, lambda state: np.multiply(state.u, 1 + share, out=state.u))


def pressed(label: str, change: Callable[[np.ndarray], object]) -> Plant:
    return lambda there: there.bend(label, lambda state: change(state.pressure))


def negate_least(p: np.ndarray) -> None:
    p[np.flatnonzero(p > 0)[np.argmin(p[p > 0])]] *= -1


def drop_one(p: np.ndarray) -> None:
    p[np.flatnonzero(p > 0)[0]] = 0.0


def poison(there: Elsewhere) -> None:
    def change(data: dict[str, np.ndarray]) -> None:
        data["displacement"][3, 1] = np.nan

    there.scratch(BEAM, change)


def move_a_support(data: dict[str, np.ndarray]) -> None:
    still = np.flatnonzero(~data["displacement"].any(axis=1))
    data["displacement"][still[0], 0] = 1e-6


def press_a_beam(data: dict[str, np.ndarray]) -> None:
    data["pressure"][-1] = 1.0


def record(label: str, change: Callable[[dict[str, Any]], object]) -> Plant:
    return lambda there: there.falsify(label, change)


def larger(name: str, *, step: bool, headline: bool) -> Callable[[dict[str, Any]], None]:
    def change(stated: dict[str, Any]) -> None:
        for each, wanted in ((stated["steps"][-1], step), (stated["quantities"], headline)):
            each[name] *= 1.001 if wanted else 1.0

    return change


def copied(label: str, from_label: str) -> Plant:
    return lambda there: shutil.copy(there.field(from_label), there.field(label))


def put(label: str, from_label: str) -> Plant:
    """The unknowns of another cell, with everything that follows from them."""
    return lambda there: there.bend(label, lambda state: np.copyto(state.u, there.state(from_label)[1].u))


def another_request(there: Elsewhere) -> None:
    there.falsify(BEAM, lambda stated: stated.update({**there.record(FINE), "id": there.ids[BEAM]}))


def in_the_plan(there: Elsewhere) -> None:
    path = there.archive.index_path(there.campaign)
    path.write_text(path.read_text().replace(there.ids[BEAM], "0123456789abcdef"))


FALSE: dict[str, tuple[str, Plant, str]] = {  # of which cell, what is planted, and the claim that is named
    "displacements off by 1e-6": (STRIP, scaled(STRIP, 1e-6), "equilibrium"),
    "displacements of a loose cell off by 1e-6": (LOOSE, scaled(LOOSE, 1e-6), "equilibrium"),
    "a negative pressure": (STRIP, pressed(STRIP, negate_least), "equilibrium"),
    "a slight tension": (STRIP, pressed(STRIP, lambda p: p.__setitem__(np.argmin(p), -1e-15)), "tension"),
    "a pressed node dropped": (STRIP, pressed(STRIP, drop_one), "equilibrium"),
    "all pressures larger": (STRIP, pressed(STRIP, lambda p: np.multiply(p, 1.0001, out=p)), "equilibrium"),
    "a pressure where nothing can touch": (BEAM, lambda there: there.scratch(BEAM, press_a_beam), "field"),
    "a support that moves": (BEAM, lambda there: there.scratch(BEAM, move_a_support), "field"),
    "a quantity": (FINE, record(FINE, larger("tip_deflection_mm", step=True, headline=True)), "tip_deflection_mm"),
    "a headline": (LINEAR, record(LINEAR, larger("tip_deflection_mm", step=False, headline=True)), "tip_deflection_mm"),
    "a quantity more": (FINE, record(FINE, lambda told: told["quantities"].update(sag_mm=1.0)), "quantities"),
    "the field of another mesh": (BEAM, copied(BEAM, FINE), "field"),
    "the file of another measure": (BEAM, copied(BEAM, LINEAR), "field"),
    "the field of another measure": (BEAM, put(BEAM, LINEAR), "equilibrium"),
    "the load of another level": (
        LINEAR,
        record(LINEAR, lambda told: told["steps"][-1].update(load_fraction=1.1)),
        "load",
    ),
    "the field of another load": (BEAM, scaled(BEAM, -0.5), "equilibrium"),
    "no number in the field": (BEAM, poison, "field"),
    "a load left out": (FINE, record(FINE, lambda told: told["steps"].pop(0)), "outcome"),
    "another request": (BEAM, another_request, "request"),
    "another identity": (BEAM, in_the_plan, "identity"),
    "a smaller residual": (
        LOOSE,
        record(LOOSE, lambda t: t["steps"][-1]["kkt"].update(equilibrium=1e-9)),
        "equilibrium",
    ),
    "no failures": (LINEAR, record(LINEAR, lambda told: told["steps"][-1].pop("failures")), "failures"),
    "no residual": (LOOSE, record(LOOSE, lambda told: told["steps"][-1].update(kkt={})), "equilibrium"),
    "a wider tolerance": (STRIP, record(STRIP, lambda told: told["settings"].update(tolerance=1e-3)), "request"),
    "fewer unknowns": (FINE, record(FINE, lambda told: told["counters"].update(dofs=24)), "dofs"),
    "fewer operations": (LINEAR, record(LINEAR, lambda told: told["counters"].update(operations=1)), "operations"),
    "class without outcome": (FINE, record(FINE, lambda told: told.update(outcome="diverged")), "class"),
    "no field": (LINEAR, record(LINEAR, lambda told: told.update(files=[])), "field"),
}


def only_refused(found: Summary, claims: dict[str, str]) -> None:
    """Asserts that these cells alone are refused, each for one of its claims, which are parted by bars."""
    assert len(found.refused) == len(claims), found.refused
    for label, claim in claims.items():
        (line,) = (each for each in found.refused if each.startswith(f"{label} ("))
        assert any(f"): {each}" in line for each in claim.split("|")), line


def together() -> list[list[str]]:
    """Names of FALSE, at most one a cell in each list: to merge a store costs the same however many of them lie."""
    rounds: list[list[str]] = []
    for name, (label, _, _) in FALSE.items():
        free = (each for each in rounds if label not in [FALSE[other][0] for other in each])
        if (open_one := next(free, None)) is None:
            rounds.append(open_one := [])
        open_one.append(name)
    return rounds


@pytest.mark.parametrize("names", together(), ids=", ".join)
def test_false_claims_are_refused_and_named_and_the_rest_is_taken(
    names: list[str], elsewhere: Elsewhere, tmp_path: Path
) -> None:
    claims = {FALSE[name][0]: FALSE[name][2] for name in names}
    for name in names:
        FALSE[name][1](elsewhere)
    actual = merge(elsewhere.root, tmp_path / "here")
    only_refused(actual, claims)
    assert actual.counts == {VERIFIED: len(elsewhere.ids) - len(claims)}
    assert not any(Archive(tmp_path / "here").record_path(elsewhere.ids[label]).exists() for label in claims)


def test_an_honest_store_is_taken_in_whole(elsewhere: Elsewhere, tmp_path: Path) -> None:
    actual = merge(elsewhere.root, tmp_path / "here")
    assert (actual.counts, actual.refused) == ({VERIFIED: 6}, [])
    here = Archive(tmp_path / "here")
    assert here.campaigns() == ["beams"]
    for label, cell_id in elsewhere.ids.items():
        stated, ours = elsewhere.record(label), here.record(cell_id)
        assert ours is not None
        assert {key: ours[key] for key in stated} == {**stated, "timing_s": {}}
        assert ours["merged"]["timing_s"] == stated["timing_s"]
        assert ours["merged"]["status"] == VERIFIED
        assert ("loads before the last" in ours["merged"]["claimed"]) == (len(stated["steps"]) > 1)
        assert here.has(cell_id, files=True)


def test_what_was_merged_can_be_merged_on(elsewhere: Elsewhere, tmp_path: Path) -> None:
    merge(elsewhere.root, tmp_path / "here")
    assert merge(tmp_path / "here", tmp_path / "third").counts == {VERIFIED: 6}
    ours = Archive(tmp_path / "third").record(elsewhere.ids[BEAM])
    assert ours is not None
    assert ours["merged"]["timing_s"] == elsewhere.record(BEAM)["timing_s"]


def grow(told: dict[str, Any]) -> None:
    told["quantities"]["inflated_equator_outer_mm"] *= 1.001


HARD: dict[str, tuple[str, Plant, str]] = {
    "displacements off by 1e-6": (TYRE, scaled(TYRE, 1e-6), "equilibrium"),
    "a pressed node dropped": (TYRE, pressed(TYRE, drop_one), "equilibrium"),
    "unstable": (
        TYRE,
        record(TYRE, lambda t: (t.update({"class": "unstable"}), t["steps"][-1]["stability"].update(word="unstable"))),
        "stability",
    ),
    "an inflation": (TYRE, record(TYRE, grow), "inflated_equator_outer_mm"),
    "a force": (TYRE, record(TYRE, larger("force_N", step=True, headline=True)), "force_N"),
    "the end of a curve": (CAP, scaled(CAP, 1e-6), "equilibrium"),
    "another end of a curve": (
        CAP,
        record(CAP, lambda t: t["steps"][-1].update(load_fraction=0.9)),
        "equilibrium|load",
    ),
    "convergence": (
        FAILS,
        record(FAILS, lambda t: t.update({"outcome": "converged", "class": "converged"})),
        "outcome",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HARD)
def test_a_false_claim_of_stages_and_curves_is_refused(name: str, tyres_elsewhere: Elsewhere, tmp_path: Path) -> None:
    label, plant, claim = HARD[name]
    plant(tyres_elsewhere)
    only_refused(merge(tyres_elsewhere.root, tmp_path / "here"), {label: claim})


@pytest.mark.slow
def test_convergence_with_a_load_that_was_never_reached_is_refused(tyres_elsewhere: Elsewhere, tmp_path: Path) -> None:
    """The step is invented, too: the field is not in balance at the load of the request."""
    step = tyres_elsewhere.record(TYRE)["steps"][-1]

    def invent(stated: dict[str, Any]) -> None:
        stated.update({"outcome": "converged", "class": "converged", "steps": [{**step, "delta_mm": 0.0}]})

    tyres_elsewhere.falsify(FAILS, invent)
    (line,) = merge(tyres_elsewhere.root, tmp_path / "here").refused
    assert line.startswith(f"{FAILS} (")


@pytest.mark.slow
def test_a_failure_is_taken_as_unverified_without_what_it_claims_to_have_found(
    tyres_elsewhere: Elsewhere, tmp_path: Path
) -> None:
    tyres_elsewhere.falsify(FAILS, lambda stated: stated["quantities"].update(force_N=1.0))
    actual = merge(tyres_elsewhere.root, tmp_path / "here")
    assert (actual.counts, actual.refused) == ({VERIFIED: 2, UNVERIFIED: 1}, [])
    ours = Archive(tmp_path / "here").record(tyres_elsewhere.ids[FAILS])
    assert ours is not None
    assert ours["class"] not in ("converged", "unstable")
    assert ours["merged"]["status"] == UNVERIFIED
    assert (ours["quantities"], ours["steps"], ours["counters"], ours["timing_s"]) == ({}, [], {}, {})
