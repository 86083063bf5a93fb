"""Grounding of worlds in which robots walk."""
