"""Grounding in finite worlds, where models, policies and transformers are tables."""
