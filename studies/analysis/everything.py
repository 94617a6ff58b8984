"""All tables of the analysis of a campaign, into STORE/tables; the reports only read them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import pandas as pd

from studies.analysis.advice.choose import shipped_tables
from studies.analysis.advice.held_out import held_out, summary
from studies.analysis.disagreements import disagreements
from studies.analysis.elements import ENOUGH, EQUAL, FARTHER, element_choice, thickness_share
from studies.analysis.evidence import Evidence, Tables
from studies.analysis.friction import COST_BARS, FULL, GRECO, all_orders, by_algorithm, ends, step_orders
from studies.analysis.ladders import convergence
from studies.analysis.ladders import summary as summary_of_ladders
from studies.analysis.outcomes import contact_summary, outcomes
from studies.analysis.powers import (
    BELOW,
    NEAR,
    NOTHING_LEFT,
    THEORY,
    contact_orders,
    distortion_orders,
    epsilon_laws,
    law_rules,
    manufactured_orders,
    rigid_body_powers,
)
from studies.analysis.printed_pressures import DEPTH, tyre_comparison, tyre_readings
from studies.analysis.programs import agreement, peer_factors
from studies.analysis.shell_limits import boundaries
from studies.analysis.statements.claims import claims_table
from studies.analysis.statements.tables import statement_tables
from studies.analysis.tyre import BEHIND, SAME, grids_reaching, solid_shell, tyre_budget, tyre_models
from studies.analysis.uncertainty import TIMES, axial_states, error_budget, error_statements, input_effects, statements
from studies.analysis.verify import verified
from studies.ask.scene import UsageError
from studies.catalogue.tables import catalogue_tables
from studies.experiments.choices import measure_limits
from studies.output.atomic import write_table
from studies.run.collect import collect, machines
from studies.run.rows import published, reference_rows
from studies.solving.refinement.richardson import FORMAL, SAFE, SAME_ORDER, SAME_VALUE, UNSAFE
from studies.solving.trials import PATIENCE

FITTED: Mapping[str, tuple[str, Callable[[pd.DataFrame], pd.DataFrame]]] = {  # by the table that they are fitted to
    "measure_limits": ("choices", measure_limits),
    "grids_reaching": ("work_precision", grids_reaching),
    "rigid_body_powers": ("small_motions", rigid_body_powers),
    "epsilon_laws": ("epsilon", epsilon_laws),
    "error_statements": ("error_coverage", error_statements),
    "stated_errors": ("error_coverage", statements),
    "ring_budget": ("crushed_ring", error_budget),
    "ring_inputs": ("crushed_ring", input_effects),
    "ring_states": ("crushed_ring", axial_states),
    "law_rules": ("law_strain", law_rules),
    "peer_factors": ("peers", peer_factors),
    "manufactured_orders": ("manufactured", manufactured_orders),
    "manufactured_contact_orders": ("manufactured_contact", contact_orders),
    "distortion_orders": ("distortion", distortion_orders),
    "shell_boundaries": ("shell_limits", boundaries),
    "friction_drag_ends": ("friction_dragged", partial(ends, key="drag_mm")),
    "friction_turn_ends": ("friction_turned", partial(ends, key="turn_deg")),
    "friction_step_orders": ("friction_steps", step_orders),
    "friction_algorithms": ("friction_agreement", by_algorithm),
}

RULES = {  # thresholds that the pages state
    "formal_order": FORMAL,
    "same_order": SAME_ORDER,
    "same_value": SAME_VALUE,
    "safe": SAFE,
    "unsafe": UNSAFE,
    "enough": ENOUGH,
    "equal": EQUAL,
    "farther": FARTHER,
    "same_model": SAME,
    "behind": BEHIND,
    "core_depth": DEPTH,
    "strain_rounding": NOTHING_LEFT,
    "near_order": NEAR,
    "coarse_below": BELOW,
    **{name.replace("error_", "theory_"): order for name, order in THEORY.items()},
    "expensive": TIMES,
    "patience": PATIENCE,
    "friction_full": FULL,
    "friction_greco": GRECO,
    **COST_BARS,
}


def analyse(store: Path, campaign: str) -> list[Path]:
    """Write the tables of a campaign; returns their paths. Raises UsageError when it has no cell with an answer."""
    table = collect(store, campaign)
    tables = analysed(table) | compared(store, campaign, table)
    paths = written(store, campaign, tables)
    paths += written(store, campaign, catalogue_tables(store, campaign, tables["convergence"]))
    paths += written(store, campaign, statement_tables(store, campaign))
    return [*paths, *written(store, campaign, claims_table(store, campaign))]


def written(store: Path, campaign: str, tables: Mapping[str, pd.DataFrame]) -> list[Path]:
    """Put tables of a campaign into the store; returns their paths."""
    paths = []
    for name, table in tables.items():
        path = store / "tables" / f"{name}.csv"
        write_table(path, table.assign(campaign=campaign))
        paths.append(path)
    return paths


def compared(store: Path, campaign: str, table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables that hold answers beside other answers, and what is fitted to the tables of experiments."""
    evidence = Evidence(store, campaign)
    answers = evidence.answers
    sequences, errors = convergence(answers, table)
    solids = solid_shell(answers)
    every = pd.concat([table, collect(store, campaign, apart=True)], ignore_index=True)
    return {
        "rules": pd.DataFrame([RULES]),
        "machines": machines(every),
        **published(every),
        "convergence": sequences,
        "convergence_errors": errors,
        "convergence_summary": summary_of_ladders(sequences, errors),
        "element_choice": element_choice(sequences),
        "thickness_share": thickness_share(answers, sequences, errors),
        **tyre_comparison(answers),
        "tyre_readings": tyre_readings(answers),
        "solid_shell": solids,
        "tyre_budget": tyre_budget(answers, evidence.table, solids),
        "tyre_models": tyre_models(answers),
        **fitted(evidence.table),
    }


def fitted(tables: Tables) -> dict[str, pd.DataFrame]:
    """What is fitted to the tables of experiments that are there."""
    found = {name: (tables(source), fit) for name, (source, fit) in FITTED.items()}
    made = {name: fit(table) for name, (table, fit) in found.items() if table is not None}
    if (programs := tables("programs")) is not None:
        made["program_agreement"] = agreement(programs, tables("peers"))
    if (orders := all_orders(tables)) is not None:
        made["friction_orders"] = orders
    return made


def analysed(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables over all cells, from a collected one; raises UsageError when no cell of it has an answer."""
    if table.empty or not (table["outcome"] == "converged").any():
        raise UsageError("nothing to analyse: no cell of the campaign has converged")
    references = reference_rows(table)
    split = verified(table, references)
    cases = held_out(table, split)
    return {
        "verified": split,
        "outcomes": outcomes(table),
        "contact_summary": contact_summary(table),
        "disagreements": disagreements(table),
        "held_out": cases,
        "held_out_summary": summary(cases),
        **shipped_tables(table, split),
    }
