"""Checks recordings before anything is fitted: what can they show, and what not?

`check` measures noise and defects, computes for each effect the smallest size that the
recordings would tell, and proposes motions with which smaller ones would be told.
"""

from diagnosis.check.check import check

__all__ = ["check"]
