"""Grids for a quantity: what its error is made of, where to refine for it, and what two grids say of its limit."""
