"""The answer of a diagnosis as data, and as JSON that other programs can read.

`Verdict` holds everything; docs/diagnosis_json.md documents its file field by field.
"""

from diagnosis.verdict.parts import (
    Amount,
    Estimate,
    Found,
    MismatchCell,
    NextExperiment,
    PlacedEffect,
    Pulse,
    PulseSource,
    Recordings,
    Unexplained,
    When,
)
from diagnosis.verdict.verdict import ChannelFit, Errors, Fit, Verdict, VerdictKind

__all__ = [
    "Amount",
    "ChannelFit",
    "Errors",
    "Estimate",
    "Fit",
    "Found",
    "MismatchCell",
    "NextExperiment",
    "PlacedEffect",
    "Pulse",
    "PulseSource",
    "Recordings",
    "Unexplained",
    "Verdict",
    "VerdictKind",
    "When",
]
