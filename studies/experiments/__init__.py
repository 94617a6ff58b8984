"""Experiments with a question of their own, each ending in tables of the store. No page and no campaign enters here."""
