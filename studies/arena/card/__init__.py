"""The card of a newcomer: what a file adds, the laws it keeps, its claims, its cost beside ours, on one page.

Nothing is defined here that the suite solves with: what is tried comes from a file (:mod:`studies.scenes.plugins`) or
from the catalogues, and problems from the collection, from requests, or from an answer that was chosen first.
"""
