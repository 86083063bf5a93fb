"""`groundwalk concealed`: recordings whose hidden physics a diagnosis must find."""

from experiments.command_line import Verb

STUDIES = {
    "make": Verb("concealed.make", "ConcealedMake", "draw cases and seal their truth"),
    "run": Verb("concealed.run", "ConcealedRun", "diagnose the cases"),
    "score": Verb("concealed.score", "ConcealedScore", "open the truth and count"),
}
"""The verbs of `groundwalk concealed`, the steps of a study, by name."""
