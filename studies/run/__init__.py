"""Many requests: campaigns, the store of their results, the pool that solves them. No conclusion is drawn here."""
