"""Paths of problems: load stepping, contact candidates, arc length, critical points. No algorithm by name."""
