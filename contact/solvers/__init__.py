"""Numerical solvers: sparse systems, linear complementarity problems, quadratic programmes. No contact problem."""
