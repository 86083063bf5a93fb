"""The answer of a diagnosis as data, and as JSON that other programs can read.

`Verdict` holds everything; docs/diagnosis_json.md documents its file field by field.
"""

from diagnosis.verdict.parts import Amount as Amount
from diagnosis.verdict.parts import Estimate as Estimate
from diagnosis.verdict.parts import Found as Found
from diagnosis.verdict.parts import MismatchCell as MismatchCell
from diagnosis.verdict.parts import NextExperiment as NextExperiment
from diagnosis.verdict.parts import PlacedEffect as PlacedEffect
from diagnosis.verdict.parts import Pulse as Pulse
from diagnosis.verdict.parts import PulseSource as PulseSource
from diagnosis.verdict.parts import Recordings as Recordings
from diagnosis.verdict.parts import Unexplained as Unexplained
from diagnosis.verdict.parts import ValueRange as ValueRange
from diagnosis.verdict.parts import When as When
from diagnosis.verdict.verdict import ChannelFit as ChannelFit
from diagnosis.verdict.verdict import Errors as Errors
from diagnosis.verdict.verdict import Fit as Fit
from diagnosis.verdict.verdict import Verdict as Verdict
from diagnosis.verdict.verdict import VerdictKind as VerdictKind
