"""What users of Python meet: ``from studies import solve, describe, choose``.

Everything is checked and solved elsewhere; no rule about a value enters here.
"""
