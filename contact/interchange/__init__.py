"""Contact problems on their own: a linearised step as a file, those of others, independent oracles. No model."""
