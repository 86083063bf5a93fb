"""Turns a search's result into a verdict: intervals, probabilities and controls."""
