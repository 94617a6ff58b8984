"""The six algorithms with friction and what they share; each is one file. No mechanics and no judge may enter here."""
