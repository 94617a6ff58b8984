"""The tables of the whole store, and who makes each."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from studies.arena.collected.rule import STEPS
from studies.door.plugins import modules
from studies.experiments.accuracy.choices import choices
from studies.experiments.accuracy.error_coverage import error_coverage
from studies.experiments.accuracy.work_precision import work_precision_study
from studies.experiments.crushed_ring import crushed_ring_study
from studies.experiments.epsilon import epsilon_study
from studies.experiments.extremes.limits import limits_table
from studies.experiments.extremes.maps import axes_table, check_table, extremes_table
from studies.experiments.friction.closed_forms.drum import capstan_table, drum_table
from studies.experiments.friction.closed_forms.patch import parking_table
from studies.experiments.friction.closed_forms.rolling import rolling_table
from studies.experiments.friction.closed_forms.strip import strip_table
from studies.experiments.friction.discrete.greco import friction_table
from studies.experiments.friction.discrete.joint_motion import joint_motion_table
from studies.experiments.friction.discrete.klarbring import klarbring_table
from studies.experiments.friction.discrete.limits import tied_table
from studies.experiments.friction.discrete.path_error import path_table
from studies.experiments.friction.public.public_problems import public_table
from studies.experiments.friction.scenes import rubbed_scenes
from studies.experiments.friction.scenes.agreement import agreement_table
from studies.experiments.friction.scenes.cost import cost_table
from studies.experiments.invariance.symmetry import symmetry_table
from studies.experiments.invariance.tyre_mirror import mirror_table
from studies.experiments.law_strain import law_strain_study
from studies.experiments.locking import curved_beam, membrane_locking, shear_locking, thickness_locking
from studies.experiments.manufactured import manufactured, manufactured_contact, statements
from studies.experiments.obstacle_problems.active_set_cycles import cycles
from studies.experiments.obstacle_problems.false_success import table as false_success
from studies.experiments.obstacle_problems.membrane import membrane_table
from studies.experiments.planted_faults import planted_faults
from studies.experiments.rigid_body import rigid_body_table, rotation_sweep, small_motions
from studies.experiments.rotations import rotations_table
from studies.experiments.shell_limits.catalogue import shell_limits
from studies.experiments.solids.greco_plate import greco_table
from studies.store.atomic import SCHEMA, write_table_once
from studies.store.source_hash import packages_of, sources_hash

TABLES: dict[str, Callable[[], pd.DataFrame]] = {
    "rigid_body": rigid_body_table,
    "small_motions": small_motions,
    "rotation_sweep": rotation_sweep,
    "rotations": rotations_table,
    "thickness_locking": thickness_locking,
    "shear_locking": shear_locking,
    "curved_beam": curved_beam,
    "membrane_locking": membrane_locking,
    "epsilon": epsilon_study,
    "cycles": cycles,
    "false_success": false_success,
    "membrane": membrane_table,
    "greco_plate": greco_table,
    "symmetry": symmetry_table,
    "mirror": mirror_table,
    "extremes": extremes_table,
    "extremes_maps": axes_table,
    "extremes_check": check_table,
    "extremes_limits": limits_table,
    "shell_limits": shell_limits,
    "choices": choices,
    "work_precision": work_precision_study,
    "error_coverage": error_coverage,
    "crushed_ring": crushed_ring_study,
    "law_strain": law_strain_study,
    "manufactured": manufactured,
    "manufactured_contact": manufactured_contact,
    "manufactured_statements": statements,
    "fuzz_faults": planted_faults,
    "friction_dragged": rubbed_scenes.dragged_table,
    "friction_turned": rubbed_scenes.turned_table,
    "friction_patch": rubbed_scenes.patch_table,
    "friction_steps": rubbed_scenes.steps_table,
    "friction_symmetry": rubbed_scenes.symmetry_table,
    "friction_crushed_ring": rubbed_scenes.crushed_table,
    "friction_cost": cost_table,
    "friction_agreement": agreement_table,
    "friction_greco": friction_table,
    "friction_klarbring": klarbring_table,
    "friction_strip": strip_table,
    "friction_drum": drum_table,
    "friction_capstan": capstan_table,
    "friction_parking": parking_table,
    "friction_rolling": rolling_table,
    "friction_path": path_table,
    "friction_joint_motion": joint_motion_table,
    "friction_tied": tied_table,
    "friction_public": public_table,
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
    folders = {Path(inspect.getfile(make)).parent, *packages_of(make.__module__)}
    files = sorted(path for folder in folders for path in folder.iterdir() if path.suffix in (".csv", ".json"))
    return " " + hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest() if files else ""
