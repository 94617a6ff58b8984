"""Commands that measure: what a solve costs and how it grows, the harness, other programs, and solvers of frozen steps.

How a thing is measured is in :mod:`studies.bench` and :mod:`studies.arena`; no clock is read here.
"""
