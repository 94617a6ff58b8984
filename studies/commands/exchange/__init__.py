"""Commands on what goes to others or comes from them: decks, fields, frozen problems, answers, and parts on a card.

Formats and their judges are in :mod:`studies.exchange` and :mod:`studies.arena`; nothing is read or judged here.
"""
