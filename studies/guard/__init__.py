"""The gate: a fresh campaign against the committed baseline, and times of two stores. Nothing is solved here."""
