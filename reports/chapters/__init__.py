"""The pages, a folder for each subject. Only tables are read; nothing of ours beside :mod:`reports` is imported."""
