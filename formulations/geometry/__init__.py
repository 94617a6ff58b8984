"""Geometry: reference surfaces, the grid on them, and the order in which its nodes are eliminated. No mechanics."""
