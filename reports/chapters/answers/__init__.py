"""Pages that answer: page one's sections, what users ask, the words, and all findings."""
