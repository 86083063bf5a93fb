"""What recordings are worth before anything is read out of them."""
