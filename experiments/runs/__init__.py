"""Runs: folders, options, progress, worker processes, and steps that may fail.

A run folder holds the options of a run, its state and its results; a run that was
stopped is continued from it.
"""
