"""`groundwalk concealed`: recordings whose hidden physics a diagnosis must find."""

from experiments.command_line import Verb

STUDIES = {
    "make": Verb("ConcealedMake", "draw cases and seal their truth", "concealed.make"),
    "run": Verb("ConcealedRun", "diagnose the cases", "concealed.run"),
    "score": Verb("ConcealedScore", "open the truth and count", "concealed.score"),
}
"""The steps of a study of concealed test cases (`groundwalk concealed`), by name."""
