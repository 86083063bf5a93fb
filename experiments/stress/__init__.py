"""Terrain stress test: walks on harder and harder ground, and causes of falls."""
