"""Pages of the limits: symmetry and invariance, extremes."""
