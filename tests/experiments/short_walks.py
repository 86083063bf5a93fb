"""Searches whose walks end soon."""

from experiments.walking.trials import TrialRules

SEARCHED = TrialRules(limit_s=3.0)


def shorten_searches(patch):
    """Let walks of optimize-gait end soon after the flat start area."""
    for name in ("SEARCH_TRIAL", "RATED"):
        patch.setattr(f"experiments.walking.gait_search.{name}", SEARCHED)
