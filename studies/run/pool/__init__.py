"""The pool: engines, and child processes with limits of time and memory. What a task computes does not enter here."""
