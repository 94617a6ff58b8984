"""What is said on the pages of shells: benchmarks, convergence, locking, strain measures, and the tyre.

Numbers come from tables that are written already; nothing may be computed here but what a sentence counts or compares.
"""
