"""Motions that excite a robot's physics: in the air, and standing on its feet."""
