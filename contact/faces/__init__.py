"""Contact between faces that both deform: nothing of shells, of solids or of any element enters here."""
