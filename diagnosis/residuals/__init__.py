"""Differences between replays of a robot model and its recordings, in units of noise.

`predictor.Predictor` replays models and returns residuals. The other modules say which
channels are compared, what counts as noise, and where and when the error is large.
"""
