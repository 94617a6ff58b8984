"""Derivatives of solved answers with their settings, and the judge of them; no answer is computed here."""
