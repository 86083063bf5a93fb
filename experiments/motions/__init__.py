"""Motions that excite a robot's physics: in the air, and standing or walking."""
