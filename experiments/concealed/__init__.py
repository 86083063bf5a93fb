"""`groundwalk concealed`: recordings whose hidden physics a diagnosis must find."""

from experiments.command_line import Verb

STUDIES = {
    "make": Verb("ConcealedMake", "draw cases and seal their truth", "concealed.make"),
    "run": Verb("ConcealedRun", "diagnose the cases", "concealed.run"),
    "score": Verb("ConcealedScore", "open the truth and count", "concealed.score"),
}
"""The verbs of `groundwalk concealed`, the steps of a study, by name."""
