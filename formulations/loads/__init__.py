"""Loads: pressure, couples, nodal forces, loads along grid lines. No support and no contact."""
