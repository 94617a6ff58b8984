"""What unilateral contact is, with friction and without: problem, judge, foundations, Newton, paths, algorithms.

Nothing here knows of shells, scenes or reports; a mechanical model is seen only as ``linearise(u, memory)``, gaps and
weights. This package imports none of the others.

Signs: the gap is positive when open, the contact pressure is positive when it pushes the body off the foundation.
"""
