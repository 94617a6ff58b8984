"""What was measured, beside what is computed."""
