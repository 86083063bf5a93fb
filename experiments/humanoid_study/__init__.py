"""The study of `groundwalk humanoids`: what limits each robot, and its page."""
