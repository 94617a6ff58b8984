"""The page of the arena. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
