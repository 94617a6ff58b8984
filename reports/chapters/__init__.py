"""The pages, a module each. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
