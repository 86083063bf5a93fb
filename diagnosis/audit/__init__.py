"""The audit of recordings before a diagnosis: are they usable, and what limits them?

`audit` measures all channels (noise, quanta, gaps, clipping), joints (range, speed,
reversals) and clocks, and words findings for the report.
"""

from diagnosis.audit.audit import audit
from diagnosis.audit.result import Audit, Finding

__all__ = ["Audit", "Finding", "audit"]
