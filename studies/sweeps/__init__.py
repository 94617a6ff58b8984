"""Sweeps: a scene over one or two settings, every combination solved from its neighbours, judged, kept and resumed.

How one request is solved does not enter here.
"""
