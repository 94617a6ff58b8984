"""The arena: linearised contact problems of real shells as files, what is asked of an answer, and who answers best.

No scene, no strain measure and no contact algorithm may be defined here.
"""
