"""Contact algorithms that are not in the catalogue and enter by ``--use``, a file each.

``footprint solve tyre --use studies/arena/entries/barrier.py --contact barrier``: see :mod:`studies.scenes.plugins`.
Nothing of the suite imports them; :mod:`studies.arena.entries.entry` has what they share. Each comes near the answer in
its own way and finishes exactly: it reads the contact set off where it stands, and exact linear steps correct and
settle it (:mod:`contact.newton.loop`), as of every algorithm of the catalogue.
"""
