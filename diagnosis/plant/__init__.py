"""The nominal model of a robot, and where it comes from."""
