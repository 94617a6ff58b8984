"""Coulomb friction on rigid foundations: the frictional problem, its law, its algorithms and its judge.

Nothing here is imported where there is no friction: a problem without it is solved by :mod:`contact.algorithms`, to the
last digit as before. No scene and no shell may enter here.
"""
