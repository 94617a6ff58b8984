"""Contact of plane elastic solids from scikit-fem with the same algorithms as shells."""
