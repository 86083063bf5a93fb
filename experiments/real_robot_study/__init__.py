"""Study of `groundwalk real-robots`: diagnoses compared with published values."""

from experiments.real_robot_study.cases import ROBOTS, RealRobot
from experiments.real_robot_study.claims import claims_of

__all__ = ["ROBOTS", "RealRobot", "claims_of"]
