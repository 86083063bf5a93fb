"""Where sim and recordings differ: what physics is missing, and a sim that has it."""
