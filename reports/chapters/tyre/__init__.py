"""The page of the tyre: its sections, the paper's printed table, its pictures."""
