"""Gymnasium environments: recording transitions, and transforming actions."""
