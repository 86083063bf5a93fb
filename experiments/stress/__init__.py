"""What the stress test on terrain does: families, walks, causes of falls, its page."""
