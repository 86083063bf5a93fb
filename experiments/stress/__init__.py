"""The terrain stress test: families of ground, walks, causes of falls, its page."""
