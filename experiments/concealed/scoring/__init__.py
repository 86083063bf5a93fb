"""Scores the answers to concealed cases against the sealed truth."""
