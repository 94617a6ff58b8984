"""The arena: linearised contact problems of real shells as files, what is asked of an answer, and who answers best.

No scene and no strain measure may be defined here, and a contact algorithm only in :mod:`.solvers`
and in the example of a submission (template).
"""
