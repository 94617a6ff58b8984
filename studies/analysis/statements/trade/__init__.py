"""What is said on the pages of the trade: what accuracy costs, who reaches it for less, and what is advised.

A price is all of a cost, seconds or operations; no sentence may rank by a part of one.
"""
