"""Coulomb friction on rigid foundations as a law of contact: slips, states, their linear steps, Newton, and the judge.

Where a problem has no friction nothing here is used, and its digits are those of contact alone. No scene and no shell
may enter here.
"""
