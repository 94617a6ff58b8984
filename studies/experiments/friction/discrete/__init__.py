"""Small discrete problems with friction whose answers are found another way. No scene may enter here."""
