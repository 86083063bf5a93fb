"""The ground floor: small modules that every other package may import.

Errors, array types, JSON of dataclasses, atomic files, gravity and BLAS threads.
"""

__version__ = "0.1.0"
