"""Rollouts written down: columns, metadata, files."""
