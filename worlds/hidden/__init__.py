"""Physics that a world can have and its nominal model lacks."""
