"""What may be asked: settings, requests, what a scene is, and parts from outside. Nothing is solved here."""
