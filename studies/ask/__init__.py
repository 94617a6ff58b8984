"""What may be asked: settings, requests, and what a scene is and declares. Nothing is solved here."""
