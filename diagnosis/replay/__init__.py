"""What variants of a plant do when they are given the commands of recordings."""
