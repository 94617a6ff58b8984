"""Steps with Coulomb friction in the collection of frozen problems: what they are, how they are certified and go out.

They stand beside the steps without friction, with a manifest of their own: solvers of those do not know them.
"""
