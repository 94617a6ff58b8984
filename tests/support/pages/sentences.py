"""A sentence of conclusion by its name."""

from __future__ import annotations

from reports.chapter import statements
from reports.store import Store


def sentence(store: Store, name: str) -> str:
    """Its text, nothing where the campaign does not make it."""
    return next((each.text for each in statements(store) if each.name == name), "")
