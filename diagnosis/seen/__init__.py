"""Seen before named: what each joint shows in recordings, without a fit of effects.

`look` compares the torque that a joint had with the torque that its recorded motion
needs by the nominal model, and gives the difference, the loss torque, as curves with
bands from recording to recording; it says with what the loss torque goes, and how late
the motion follows the commands. No verdict depends on it.
"""

from diagnosis.seen.look import look as look
from diagnosis.seen.result import Curve as Curve
from diagnosis.seen.result import Delay as Delay
from diagnosis.seen.result import Seen as Seen
from diagnosis.seen.result import SeenJoint as SeenJoint
from diagnosis.seen.result import Share as Share
