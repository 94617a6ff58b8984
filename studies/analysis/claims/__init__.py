"""Sentences that are repeated in print and in manuals, each held against the tables of a campaign.

Tables come in as they are written; nothing may be solved here, and no claim may be judged by a number typed here.
"""
