"""The tables of the whole store, and who makes each."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from studies.arena.collected.rule import STEPS
from studies.experiments import (
    choices,
    distortion,
    epsilon,
    error_coverage,
    extreme_limits,
    extremes,
    faces,
    false_success,
    locking,
    manufactured,
    membrane,
    obstacles,
    rigid_body,
    rotations,
    solid_laws,
    symmetry,
    what_if,
    work_precision,
)
from studies.experiments.friction import bars, brush, greco, klarbring, public_problems, scenes, trusses
from studies.experiments.shell_limits import ladder
from studies.fuzz import planted_faults
from studies.output.atomic import SCHEMA, write_table_once
from studies.run.source_hash import data_of, sources_hash
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
    "cycles": obstacles.cycles,
    "false_success": false_success.table,
    "membrane": membrane.membrane_table,
    "greco_plate": greco.greco_table,
    "symmetry": symmetry.symmetry_table,
    "mirror": symmetry.mirror_table,
    "extremes": extremes.extremes_table,
    "extremes_maps": extremes.axes_table,
    "extremes_check": extremes.check_table,
    "extremes_limits": extreme_limits.limits_table,
    "shell_limits": ladder.shell_limits,
    "what_if": what_if.what_if,
    "even_footprint": what_if.even_footprint,
    "every_footprint": what_if.every_footprint,
    "choices": choices.choices,
    "work_precision": work_precision.work_precision_study,
    "error_coverage": error_coverage.error_coverage,
    "crushed_ring": solid_laws.crushed_ring_study,
    "law_strain": solid_laws.law_strain_study,
    "manufactured": manufactured.manufactured,
    "manufactured_contact": manufactured.manufactured_contact,
    "manufactured_statements": manufactured.statements,
    "distortion": distortion.distortion,
    "distorted_shells": distortion.distorted_shells,
    "fuzz_faults": planted_faults.planted_faults,
    "faces": faces.faces_table,
    "faces_algorithms": faces.algorithms_table,
    "faces_cost": faces.cost_table,
    "faces_spheres": faces.spheres_table,
    "faces_ironing": faces.ironing_table,
    "friction_dragged": scenes.dragged_table,
    "friction_turned": scenes.turned_table,
    "friction_patch": scenes.patch_table,
    "friction_steps": scenes.steps_table,
    "friction_symmetry": scenes.symmetry_table,
    "friction_crushed_ring": scenes.crushed_table,
    "friction_cost": scenes.cost_table,
    "friction_agreement": scenes.agreement_table,
    "friction_greco": greco.friction_table,
    "friction_klarbring": klarbring.klarbring_table,
    "friction_strip": bars.strip_table,
    "friction_drum": bars.drum_table,
    "friction_capstan": bars.capstan_table,
    "friction_parking": brush.parking_table,
    "friction_rolling": trusses.rolling_table,
    "friction_path": brush.path_table,
    "friction_joint_motion": trusses.joint_motion_table,
    "friction_tied": greco.tied_table,
    "friction_public": public_problems.public_table,
    "problems": STEPS.manifest,
    "problems_left_out": STEPS.left_out,
}


def make_table(name: str, directory: Path) -> bool:
    """Make a table unless the one there was made by the same sources and data; returns whether it was made now."""
    make = TABLES[name]
    data = b"".join(path.read_bytes() for path in data_of(make.__module__))
    identity = f"{SCHEMA} {sources_hash([make.__module__, *modules()])}"
    identity += f" {hashlib.sha256(data).hexdigest()}" if data else ""
    return write_table_once(directory / f"{name}.csv", identity, make)
