"""Other programs on decks of ours, run as they are: which scenes, how the program is started, what is kept of it.

:mod:`.cases` lists the scenes, each a :mod:`.case`; :mod:`.calculix` runs a deck; :mod:`.measured` makes the table of
``footprint bench programs``. How a deck is written and a field is judged belongs to :mod:`studies.exchange`; no value
that a program has found may be kept in a source.
"""
