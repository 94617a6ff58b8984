"""Answers beside other answers: other meshes, elements, measures, models and bodies, references, and the printed table.

Each module makes the tables of one comparison from the records of a campaign; nothing is solved, nothing is worded.
"""
