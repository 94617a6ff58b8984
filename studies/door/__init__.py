"""What users of Python, plug-ins and a terminal meet: notebooks, descriptions, parts from outside, lines of words.

Everything is checked and solved elsewhere; no rule about a value enters here.
"""
