"""Conditions on the unknowns: the map from unknowns to face displacements, supports by name. No load."""
