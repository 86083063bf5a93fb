"""Position servos that are sold, as data with sources."""
