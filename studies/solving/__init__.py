"""A request solved and judged: on one grid, on nested grids, with other formulations beside it.

No campaign, no store and no page enter here.
"""
