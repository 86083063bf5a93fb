"""Cliff walking: the SGAT paper's study in a finite world."""
