"""Small published contact problems, and what every algorithm makes of them. No shell scene by name."""
