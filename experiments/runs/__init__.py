"""Run folders: what a run was asked, its state, its results, and how it goes on."""
