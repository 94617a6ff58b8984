"""Where solving stops: maps of outcomes over pairs of settings, and the search for their boundaries. No page."""
