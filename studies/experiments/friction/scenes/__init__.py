"""Scenes with friction: what it does, what it costs, whether algorithms agree. No model is built here."""
