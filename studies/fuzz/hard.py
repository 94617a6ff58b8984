"""Requests that were hard once: near-misses and findings of earlier campaigns, as commands.

:func:`studies.fuzz.near.grown` takes them from the table of a campaign; nothing but commands may enter here.
"""

COMMANDS = ("panel --mesh 4x4 --set shape=sphere --set delta_mm=0.2 --set mu=0.5 --set drag_mm=0.5,0",)
