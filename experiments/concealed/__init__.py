"""`groundwalk concealed`: recordings whose hidden physics a diagnosis must find."""

from experiments.command_line import Verb

STUDIES = {
    "make": Verb("concealed.make", "ConcealedMake", "draw cases and seal their truth"),
    "run": Verb("concealed.run", "ConcealedRun", "diagnose the cases"),
    "score": Verb("concealed.score", "ConcealedScore", "open the truth and count"),
}
"""The steps of a study of concealed physics, by their names on the command line."""
