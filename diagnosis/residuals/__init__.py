"""How far replays are from what was measured, and what in that is noise."""
