"""Motions that make a robot show what it is like."""
