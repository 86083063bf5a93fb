"""A sim that has the effects that were found, as files and as a world."""
