"""A shell from a file of keywords as Abaqus and CalculiX read them, or a mesh of gmsh: nothing is ignored silently.

What a deck says comes in here and becomes a scene like any other; how it is solved stays outside.
"""
