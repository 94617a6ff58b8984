"""Every number that a page concludes from a campaign is computed here, once, as a table. Nothing is solved here."""
