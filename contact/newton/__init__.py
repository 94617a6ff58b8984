"""The Newton iteration that the algorithms share: a step on a given set, the loop around it. No algorithm by name."""
