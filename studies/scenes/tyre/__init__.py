"""The tyre: its wall, grid, parts, obstacles, and the stages of its loading. Others need its readings alone."""
