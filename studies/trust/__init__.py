"""Taking results of another machine: what a cell claims is recomputed from its field before it is taken.

Nothing of a foreign store is believed that can be computed here, and what can not is marked as claimed.
"""
