"""What is said on the pages of contact: algorithms, agreement, epsilon, frozen problems, and where paths end.

Numbers come from tables that are written already; nothing may be computed here but what a sentence counts or compares.
"""
