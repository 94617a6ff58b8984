"""The page of contact algorithms: agreement, costs, false claims, cycles, penalties."""
