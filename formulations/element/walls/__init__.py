"""The mixed element with surfaces inside its wall: geometry, modes, laws. No load and no support by name."""
