"""A diagnosis' corrected sim on new recordings: its promise, checked and judged."""
