"""What a shell is: geometry, strain measures, sections, the mixed element and its loads.

Nothing here knows of contact, scenes, campaigns or reports; this package imports none of the others.
Array convention: batch axes first (elements, Gauss points), components last; every ``einsum`` carries an ellipsis.
Units are the caller's, consistently; the scenes use mm, N and MPa.
"""
