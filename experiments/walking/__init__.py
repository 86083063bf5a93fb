"""Walking: runs and records trials of gaits, evaluates gaits and searches for them.

The names in `__all__` are for use from Python. The modules `evaluation`, `search`,
`tuning` and `gait_search` are used by the verbs of the command line.
"""

from experiments.walking.recorder import Recorder
from experiments.walking.trials import (
    COURSE_TRIAL,
    SEARCH_TRIAL,
    TrialRules,
    Trials,
    reward_cm_s,
    walk_trials,
)

__all__ = [
    "COURSE_TRIAL",
    "SEARCH_TRIAL",
    "Recorder",
    "TrialRules",
    "Trials",
    "reward_cm_s",
    "walk_trials",
]
