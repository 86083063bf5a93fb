"""The audit of recordings before a diagnosis: are they usable, and what limits them?

`audit` measures all channels (noise, rounding, gaps, clipping), joints (range, speed,
reversals) and clocks, and writes its findings as sentences for the report.
"""

from diagnosis.audit.audit import audit

__all__ = ["audit"]
