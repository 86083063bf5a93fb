"""Simulations with the effects (missing physics) that a diagnosis has found.

`mjcf` writes the effects into an MJCF file, `effects_json` stores and reads them as
JSON, and `sim.CorrectedSim` simulates all of them.
"""
