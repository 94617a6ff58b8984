"""Scenes for other programs, and what other programs answer: a problem in neutral terms, its files and their judge.

:mod:`.problem` states a scene of the catalogue as a body of quadratic bricks with plies, supports, load steps and a
rigid plane; :mod:`.of_body` and :mod:`.of_scene` make it, :mod:`.deck` and :mod:`.sheet` write it. :mod:`.results`
reads what comes back, :mod:`.judging` holds it against our solution, the references and the balances. No other program
may be started in this room, no number that one has found may be kept in it, and nothing that is solved here may depend
on it.
"""
