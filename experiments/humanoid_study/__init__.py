"""The study of `groundwalk humanoids`: facts, page, figure."""
