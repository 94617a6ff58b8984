"""One Newton iteration under given states: laws, motions that obey them, one factorisation. No algorithm is here."""
