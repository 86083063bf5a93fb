"""Grounding in finite worlds, where all of it is a table."""
