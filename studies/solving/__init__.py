"""A request solved and judged: on one grid, on nested grids, with other formulations beside it.

What is enough on a reader's own scene is :mod:`studies.solving.choose`; what stored campaigns say of that is
:mod:`studies.analysis.advice`. No campaign, no store and no page enter here.
"""
