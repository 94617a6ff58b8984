"""Campaigns: their files, cells, plans and runs. How a cell is solved and what is concluded do not enter here."""
