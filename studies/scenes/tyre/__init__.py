"""The tyre: its wall, grid, parts, obstacles, and the stages of its loading. Nothing another scene needs."""
