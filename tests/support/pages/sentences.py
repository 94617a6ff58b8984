"""A sentence of conclusion by its name."""

from __future__ import annotations

from reports.store.statements import statements
from reports.store.tables import Store


def sentence(store: Store, name: str) -> str:
    """Its text, nothing where the campaign does not make it."""
    return next((each.text for each in statements(store) if each.name == name), "")
