"""When a shell is not enough: where the table of studies.experiments.shell_limits passes a level, and who is beyond.

Nothing is solved here. ``shipped.csv`` is that table without its costs, as it was when the sources were last published:
advice has it where no campaign has been run.
"""
