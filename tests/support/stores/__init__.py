"""Stores whose tables are made up, for what reads them: nothing is solved."""
