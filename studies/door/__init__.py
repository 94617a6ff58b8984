"""What users of Python and of plug-ins meet: notebooks, descriptions of the parts, and parts from outside.

Everything is checked and solved elsewhere; no rule about a value enters here.
"""
