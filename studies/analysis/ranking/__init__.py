"""Who is best, and at which price, and who did not solve what.

Costs and verified errors come in as tables; no answer may be read here, and no ranking may leave out what failed.
"""
