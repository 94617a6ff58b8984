"""Pages of the trade: what accuracy costs, what to choose, what a smaller model saves."""
