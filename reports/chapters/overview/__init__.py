"""The first page of a report, and the page that any campaign supports."""
