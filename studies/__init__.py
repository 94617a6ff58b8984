"""Scenes, solving, campaigns and their store: the room that composes formulations and contact.

Element and contact algebra must not enter here; nor may pages and pictures, which read the store alone. The names for
notebooks are in :mod:`studies.footprint`, which is ``footprint`` where it is installed.
"""
