"""Traces: recordings as arrays in a robot model's order of joints, and their analysis.

`read` reads recordings and loads their robot model. The other modules smooth, cut and
divide traces, estimate sensor noise, and find delays that jump and torques that no
servo asked for.
"""
