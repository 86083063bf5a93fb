"""Cliff walking: the tabular study of the SGAT paper."""
