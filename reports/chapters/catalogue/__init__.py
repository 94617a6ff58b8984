"""A page for every scene, measure and algorithm, and a gallery of the scenes."""
