"""The ground floor: small modules that every other package may import.

Errors, NumPy array types, JSON of dataclasses, atomic file writing, gravity, limits on
BLAS threads, and packages that import their modules lazily.
"""

__version__ = "0.1.0"
