"""Coulomb friction as an option of every scene with contact; nothing but its settings is imported without it."""
