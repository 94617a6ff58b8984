"""Strain measures: the displacement-gradient quantities, the protocol, the catalogue. No element and no material."""
