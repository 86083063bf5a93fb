"""The ground floor of the house: what every room may import, and nothing else."""

__version__ = "0.1.0"
