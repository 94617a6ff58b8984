"""All tables of the analysis of a campaign, into STORE/tables; the reports only read them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from pkgutil import resolve_name

import pandas as pd

from studies.analysis.advice.choose import shipped_tables
from studies.analysis.advice.held_out import held_out, summary
from studies.analysis.agreement import disagreements, solves
from studies.analysis.elements import element_choice, thickness_share
from studies.analysis.evidence import Evidence, Tables
from studies.analysis.friction import COST_BARS, orders
from studies.analysis.ladders import convergence
from studies.analysis.ladders import summary as summary_of_ladders
from studies.analysis.outcomes import contact_summary, outcomes
from studies.analysis.powers import THEORY
from studies.analysis.printed_pressures import tyre_comparison, tyre_readings
from studies.analysis.statements.tables import claims_table, statement_tables
from studies.analysis.tyre import solid_shell, tyre_budget, tyre_models
from studies.analysis.verify import verified
from studies.ask.scene import UsageError
from studies.catalogue.tables import catalogue_tables
from studies.output.atomic import write_table
from studies.run.answers import published, reference_rows
from studies.run.collect import collect, machines

DECLARED = tomllib.loads(Path(__file__).with_name("fitted.toml").read_text(encoding="utf-8"))


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
        "rules": pd.DataFrame([rules()]),
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
        "algorithm_agreement": solves(answers),
        **fitted(evidence.table),
    }


def rules() -> dict[str, float]:
    """Thresholds that the pages state."""
    theory = {name.replace("error_", "theory_"): order for name, order in THEORY.items()}
    return {name: resolve_name(place) for name, place in DECLARED["rules"].items()} | theory | COST_BARS


def fitted(tables: Tables) -> dict[str, pd.DataFrame]:
    """What is fitted to the tables of experiments that are there."""
    sources = {name: (tables(source), fit) for name, (source, fit) in DECLARED["fitted"].items()}
    made = {name: resolve_name(fit)(table) for name, (table, fit) in sources.items() if table is not None}
    families = {name: (tables(f"friction_{name}"), options) for name, options in DECLARED["friction_orders"].items()}
    if each := [orders(name, table, **options) for name, (table, options) in families.items() if table is not None]:
        made["friction_orders"] = pd.concat(each, ignore_index=True)
    return made


def analysed(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables over all cells, from a collected one; raises UsageError when no cell of it has an answer."""
    if table.empty or not (table["outcome"] == "converged").any():
        raise UsageError("nothing to analyse: no cell of the campaign has converged")
    references = reference_rows(table)
    split = verified(table, references)
    cases = held_out(table, split)
    return {
        "outcomes": outcomes(table),
        "contact_summary": contact_summary(table),
        "disagreements": disagreements(table),
        "held_out": cases,
        "held_out_summary": summary(cases),
        **shipped_tables(table, split),
    }
