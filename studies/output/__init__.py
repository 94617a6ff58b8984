"""What is written and printed: tables, files that are whole or not there, provenance, words for a terminal.

Nothing is solved here, and no rule about a value enters.
"""

DISTRIBUTION = "footprint-shells"  # the name of the suite among packages
