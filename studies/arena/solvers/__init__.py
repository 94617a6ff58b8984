"""Who may solve a frozen contact problem: public solvers of quadratic programmes and our own algorithms, one face each.

Beside them contact algorithms that are not in the catalogue and enter by ``--use``, a file each, which nothing of the
suite imports: ``footprint solve tyre --use studies/arena/solvers/barrier.py --contact barrier``, see
:mod:`studies.scenes.plugins`. They share :mod:`.entry`. Each comes near the answer in its own way and finishes exactly:
it reads the contact set off where it stands, and exact linear steps correct and settle it (:mod:`contact.newton.loop`),
as of every algorithm of the catalogue. Nothing is measured or judged here.
"""
