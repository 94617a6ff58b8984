"""Advice: which configuration of a scene meets a tolerance for least, what that is worth, and the tables it ships."""
