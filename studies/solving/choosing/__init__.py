"""What is enough on a reader's own scene: variants of its request on the grids of one reference, in a budget of time.

How a path is followed on a grid, and what grids say of a limit, is :mod:`studies.solving.refinement`; what stored
campaigns say is :mod:`studies.analysis.advice`. No picture is drawn here.
"""
