"""Scenes: recordings with robot and ground, and pictures of them drawn by NumPy."""
