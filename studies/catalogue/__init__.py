"""What the catalogues hold, as tables: enough of every scene, measure and algorithm to work with it in another program.

Everything is read from the parts themselves and from the models that they build. Nothing that is solved depends on it.
"""
