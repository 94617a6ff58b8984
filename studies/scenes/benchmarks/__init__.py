"""Scenes without contact: published benchmarks and closed forms. No contact, and nothing that two families share."""
