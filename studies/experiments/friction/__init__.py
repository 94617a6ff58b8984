"""Reference problems with friction: a solid, bars, rigid bodies on springs and a tyre, each with what is known of it."""
