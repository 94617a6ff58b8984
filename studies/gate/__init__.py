"""What is let in: a fresh campaign against the committed baseline, times of two stores, and results of other machines.

What a foreign cell claims is recomputed from its field before it is taken; nothing of a foreign store is believed that
can be computed here, and what can not is marked as claimed. No conclusion is drawn here.
"""
