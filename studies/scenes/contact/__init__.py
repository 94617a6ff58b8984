"""Scenes with contact of strips, plates, rings and panels. No tyre, and no reference solution."""
