"""A NAO's walks in sims grounded on walks of the real world, and searches in them."""
