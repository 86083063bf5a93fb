"""Residuals: differences of recordings and simulations, in units of sensor noise.

`predictor.Predictor` simulates robot models on recordings and returns residuals. Other
modules choose the channels to compare, learn the noise, and find when errors are large.
"""
