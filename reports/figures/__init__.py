"""How pictures are drawn: their look, bodies in space, contact maps. What one shows stands in its chapter."""
