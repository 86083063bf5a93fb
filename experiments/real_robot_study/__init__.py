"""The study of `groundwalk real-robots`: cases, claims, page."""
