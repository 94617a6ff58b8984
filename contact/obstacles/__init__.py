"""Rigid obstacles: signed distances, normals, and their derivatives. No algorithm and no mechanics of the body."""
