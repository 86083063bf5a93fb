"""Scenes and searches as files for Rerun's viewer."""
