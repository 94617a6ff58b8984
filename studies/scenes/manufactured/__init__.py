"""Manufactured solutions: scenes whose exact solution is given and whose loads follow from it.

A displacement field goes in; strains come from the statement of a measure in vectors, never from its table of
coefficients, and loads from the balance of forces, differentiated to rounding. No reference value may enter here.
"""
