"""A multifrontal factorisation: the tree of a pattern, its fronts, and what dense LAPACK makes of them.

No value enters the analysis, no pattern the factorisation; where a matrix comes from is known nowhere here.
"""
