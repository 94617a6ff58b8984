"""The pages of friction. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
