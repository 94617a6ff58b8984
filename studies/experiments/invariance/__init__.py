"""What must not change an answer: exchanged axes, units, numbering, mirrored tyres. No tolerance of a page."""
