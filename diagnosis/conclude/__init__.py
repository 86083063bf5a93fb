"""From the result of a search to a verdict: intervals, probabilities and controls."""
