"""`groundwalk concealed`: recordings whose hidden physics a diagnosis must find."""

import sys

from experiments.command_line import Verb, choose

STUDIES = {
    "make": Verb("concealed_make", "ConcealedMake", "draw cases and seal their truth"),
    "run": Verb("concealed_run", "ConcealedRun", "diagnose the cases"),
    "score": Verb("concealed_score", "ConcealedScore", "open the truth and count"),
}
"""By their names on the command line."""

if __name__ == "__main__":
    choose(STUDIES, "groundwalk concealed", sys.argv[1:], "study")
