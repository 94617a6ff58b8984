"""Sections: plies, laminates, and the stiffness they give a wall. No geometry of the shell and no displacement."""
