"""Errors of clocks, and of the times at which commands act."""
