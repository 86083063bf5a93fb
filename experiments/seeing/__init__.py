"""Pictures, films and Rerun files of walks and of searches for gaits."""
