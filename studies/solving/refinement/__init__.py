"""Grids for a quantity: what its error is made of, where to refine, what two grids say of its limit, and the loop.

Nothing about a particular scene may enter here, and no error may be stated that two grids have not shown.
"""
