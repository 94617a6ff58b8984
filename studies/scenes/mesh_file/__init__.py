"""A shell from a file of keywords as Abaqus and CalculiX read them: nothing in it is left out without a word.

What a deck says comes in here and becomes a scene like any other; how it is solved stays outside.
"""
