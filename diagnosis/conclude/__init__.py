"""From the outcome of a search to a verdict: intervals, doubts, controls."""
