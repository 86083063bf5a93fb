"""Scores the answers to concealed test cases against the sealed truth."""
