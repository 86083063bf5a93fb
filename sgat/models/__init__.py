"""Networks that learn the dynamics of real and the inverse dynamics of sim."""
