"""Random cases: requests, posed panels and small matrices drawn from a number, and the laws that each must keep.

A case is its number: the same sources draw the same case from it, on any machine, and it is solved alone. Nothing here
knows what a result ought to be; a law compares what was found with an independent statement of the same problem.
No fault is planted here: that the laws find those that are is a test. No algorithm or scene may enter by its name for
more than a span or a grid that it is small on.
"""
