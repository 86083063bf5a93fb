"""Recordings, format 1: their columns and metadata, in memory and in files."""
