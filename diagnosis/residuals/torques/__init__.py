"""Residuals in torque: what motions need, compared with what was measured or asked for.

They take the place of replays where no controller is known, and where a real robot is
far from its model.
"""
