"""Graded tasks: runs that go wrong, what may be chosen instead, what is required, and claims that are held to it.

Nothing is solved here in another way than by ``footprint solve``, and nothing is believed that a submission says.
"""
