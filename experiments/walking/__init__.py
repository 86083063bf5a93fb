"""Walking: runs and records trials of gaits, evaluates gaits and searches for them.

The names in `__all__` are for use from Python; the command line uses the modules.
"""

from experiments.walking.trials import TrialRules, Trials, walk_trials

__all__ = ["TrialRules", "Trials", "walk_trials"]
