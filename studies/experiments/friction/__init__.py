"""Reference problems with friction: a solid, bars, rigid bodies on springs, a tyre; with what is known of each."""
