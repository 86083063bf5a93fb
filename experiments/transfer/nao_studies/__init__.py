"""Studies of gaits for the NAO on uneven real ground."""
