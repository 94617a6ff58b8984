"""Who may solve a frozen contact problem: public solvers of quadratic programmes and our own algorithms, one face each.

Nothing is measured or judged here.
"""
