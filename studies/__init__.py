"""Scenes, solving, campaigns and their store: the room that composes formulations and contact.

Element and contact algebra must not enter here; nor may pages and pictures, which read the store alone.
"""
