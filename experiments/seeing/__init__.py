"""Pictures and films of walks and searches."""
