"""Contact problems on their own: a linearised step as a file, and an independent oracle for it. No model."""
