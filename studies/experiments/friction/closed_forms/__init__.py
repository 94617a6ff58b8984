"""Reference problems with friction whose answers are known in closed form. No scene may enter here."""
