"""Walking: trials of gaits, recording them, evaluating gaits and searching for them.

The names below are for use from Python; `evaluation`, `search`, `tuning` and
`gait_search` hold what the verbs are made of.
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
