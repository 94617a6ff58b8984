"""Scenes whose bodies meet one another, or themselves, and deform on both sides."""
