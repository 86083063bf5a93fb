"""The answer of a diagnosis as data, and as JSON."""
