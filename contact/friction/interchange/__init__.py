"""Steps with friction as files, those of others, and the oracle. No algorithm of ours may enter here."""
