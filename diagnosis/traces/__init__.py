"""Traces: recordings as arrays in a robot model's order of joints, and their analysis.

`read_traces` reads recordings and loads their robot model; `read_reference` reads
recordings of the healthy robot. The other modules smooth, cut and divide traces,
estimate sensor noise, and find delays that jump and torques that no servo asked for.
"""

from diagnosis.traces.read import read_reference, read_traces, trace_of
from diagnosis.traces.split import Split, split
from diagnosis.traces.trace import DriveBy, Trace, driven_by_torques

__all__ = [
    "DriveBy",
    "Split",
    "Trace",
    "driven_by_torques",
    "read_reference",
    "read_traces",
    "split",
    "trace_of",
]
