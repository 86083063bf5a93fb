"""Grounding of Gymnasium environments."""
