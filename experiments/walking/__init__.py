"""Gaits that walk: trials, rewards, searches."""
