"""The tables of the whole store, and who makes each."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from studies.arena.collected.rule import STEPS
from studies.experiments import (
    crushed_ring,
    epsilon,
    law_strain,
    locking,
    manufactured,
    rigid_body,
    rotations,
)
from studies.experiments.accuracy import choices, error_coverage, work_precision
from studies.experiments.extremes import limits, maps
from studies.experiments.friction import (
    agreement,
    bars,
    greco,
    joint_motion,
    klarbring,
    patch,
    path_error,
    rolling,
    rubbed_scenes,
)
from studies.experiments.friction.public import public_problems
from studies.experiments.invariance import symmetry, tyre_mirror
from studies.experiments.obstacle_problems import active_set_cycles, false_success, membrane
from studies.experiments.shell_limits import catalogue
from studies.fuzz import planted_faults
from studies.output.atomic import SCHEMA, write_table_once
from studies.run.store.source_hash import packages_of, sources_hash
from studies.scenes.plugins import modules

TABLES: dict[str, Callable[[], pd.DataFrame]] = {
    "rigid_body": rigid_body.rigid_body_table,
    "small_motions": rigid_body.small_motions,
    "rotation_sweep": rigid_body.rotation_sweep,
    "rotations": rotations.rotations_table,
    "thickness_locking": locking.thickness_locking,
    "shear_locking": locking.shear_locking,
    "curved_beam": locking.curved_beam,
    "membrane_locking": locking.membrane_locking,
    "epsilon": epsilon.epsilon_study,
    "cycles": active_set_cycles.cycles,
    "false_success": false_success.table,
    "membrane": membrane.membrane_table,
    "greco_plate": greco.greco_table,
    "symmetry": symmetry.symmetry_table,
    "mirror": tyre_mirror.mirror_table,
    "extremes": maps.extremes_table,
    "extremes_maps": maps.axes_table,
    "extremes_check": maps.check_table,
    "extremes_limits": limits.limits_table,
    "shell_limits": catalogue.shell_limits,
    "choices": choices.choices,
    "work_precision": work_precision.work_precision_study,
    "error_coverage": error_coverage.error_coverage,
    "crushed_ring": crushed_ring.crushed_ring_study,
    "law_strain": law_strain.law_strain_study,
    "manufactured": manufactured.manufactured,
    "manufactured_contact": manufactured.manufactured_contact,
    "manufactured_statements": manufactured.statements,
    "fuzz_faults": planted_faults.planted_faults,
    "friction_dragged": rubbed_scenes.dragged_table,
    "friction_turned": rubbed_scenes.turned_table,
    "friction_patch": rubbed_scenes.patch_table,
    "friction_steps": rubbed_scenes.steps_table,
    "friction_symmetry": rubbed_scenes.symmetry_table,
    "friction_crushed_ring": rubbed_scenes.crushed_table,
    "friction_cost": rubbed_scenes.cost_table,
    "friction_agreement": agreement.agreement_table,
    "friction_greco": greco.friction_table,
    "friction_klarbring": klarbring.klarbring_table,
    "friction_strip": bars.strip_table,
    "friction_drum": bars.drum_table,
    "friction_capstan": bars.capstan_table,
    "friction_parking": patch.parking_table,
    "friction_rolling": rolling.rolling_table,
    "friction_path": path_error.path_table,
    "friction_joint_motion": joint_motion.joint_motion_table,
    "friction_tied": greco.tied_table,
    "friction_public": public_problems.public_table,
    "problems": STEPS.manifest,
    "problems_left_out": STEPS.left_out,
}


def make_table(name: str, directory: Path) -> bool:
    """Make a table unless the one there was made by the same sources and data; returns whether it was made now."""
    make = TABLES[name]
    identity = f"{SCHEMA} {sources_hash([make.__module__, *modules()])}{_data_of(make)}"
    return write_table_once(directory / f"{name}.csv", identity, make)


def _data_of(make: Callable[[], pd.DataFrame]) -> str:
    """Hash of the tables and lists beside the module of a maker and in the packages it imports; nothing without any."""
    folders = {Path(inspect.getfile(inspect.unwrap(make))).parent, *packages_of(make.__module__)}
    files = sorted(path for folder in folders for path in folder.iterdir() if path.suffix in (".csv", ".json"))
    return " " + hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest() if files else ""
