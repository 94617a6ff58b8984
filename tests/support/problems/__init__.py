"""Shells, obstacles and contact problems that tests solve, and second ways to solve them."""
