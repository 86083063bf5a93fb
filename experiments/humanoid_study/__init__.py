"""Study of `groundwalk humanoids`: measures of what limits a robot, and the page."""
