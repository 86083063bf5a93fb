"""The real robots that are diagnosed, with published values of their physics."""

from collections.abc import Mapping
from dataclasses import dataclass

from diagnosis.traces.trace import DriveBy
from worlds import ServoGains


@dataclass(frozen=True)
class Published:
    """A published value of a parameter of a real robot.

    Attributes:
      effect: name of the effect, such as "coulomb_friction".
      parameter: name of the effect's parameter.
      value: the value in SI units, with the sign convention of the parameter.
      text: the quantity in words, for the report page.
    """

    effect: str
    parameter: str
    value: float
    text: str


@dataclass(frozen=True)
class Sane:
    """Bounds of a parameter that are plausible for a robot's hardware.

    Attributes:
      low: smallest plausible value, in the parameter's unit.
      high: largest plausible value, in the same unit.
      why: source of the bounds.
    """

    low: float
    high: float
    why: str


@dataclass(frozen=True)
class RealRobot:
    """A real robot's recordings, and known values to compare its diagnosis with.

    Attributes:
      title: title of the report page.
      folder: name of the robot's subfolder in the folder of all recordings.
      model: name of the robot, or a model file in that subfolder.
      source: where the recordings come from, and their licence.
      about: where data, model and servo gains come from, as a paragraph for the page.
      gains: gains of all servos; None if the recordings or the model state them.
      drive: "servos" or "torques", as in `groundwalk diagnose --drive`.
      least_share: as in `groundwalk diagnose --least-share`; None for its default.
      published: published values of parameters.
      sane: plausible bounds of parameters, by "effect.parameter".
      pulses: number of force pulses that the experimenters added at the actuator's
        input.
      twice: whether the page claims that with the effects found the held-out motions
        of every joint are predicted with at most half the error.

    Example:
      >>> RealRobot("My arm", "arm", "arm.urdf", "recorded by us", "A paragraph.")
    """

    title: str
    folder: str
    model: str
    source: str
    about: str
    gains: ServoGains | None = None
    drive: DriveBy = "servos"
    least_share: float | None = None
    published: tuple[Published, ...] = ()
    sane: Mapping[str, Sane] | None = None
    pulses: int = 0
    twice: bool = False


_SO101_KP, _SO101_LIMIT = 7.8, 2.94
"""Stiffness [N m/rad] and stall torque [N m] of the SO-101's servos; the text `about`
of that robot gives the sources."""

ROBOTS = {
    "so101": RealRobot(
        title="SO-101: what the URDF with ideal servos lacks",
        folder="so101",
        model="so101",
        source="the SAGE data set (Apache-2.0)",
        about="""Twelve motions of a real arm (SAGE data set, Apache-2.0); what its
model lacks is not known. The model is `so101.urdf` of example-robot-data with the
servos of the data sheet (Feetech STS3215 at 12 V): stall torque 2.94 N m, no load at
45 rpm, so 0.62 N m s/rad of back-EMF; its firmware's P of 16 is a duty cycle of 2.66
per radian (0.166 each, as Rhoban's BAM measured it), so 7.8 N m/rad.""",
        gains=ServoGains(_SO101_KP, 0.62, _SO101_LIMIT),
        twice=True,
        sane={
            "servo_gain.factor": Sane(0.5, 2.0, "4 to 15 N m/rad are plausible"),
            "servo_damping.factor": Sane(0.2, 3.0, "supply of 6 to 14 V, and gears"),
            "viscous_friction.coefficient": Sane(0.0, 0.6, "less than the back-EMF"),
            "coulomb_friction.torque": Sane(0.01, 0.6, "a fifth of the stall torque"),
            "stribeck_friction.coulomb_torque": Sane(0.0, 0.6, "as dry friction"),
            "stribeck_friction.extra_torque": Sane(0.0, 0.6, "as dry friction"),
            "load_friction.share": Sane(0.0, 0.7, "plastic and metal spur gears"),
            **{
                f"{rung}.{name}": sane
                for rung in ("gear_friction", "gear_stribeck_friction")
                for name, sane in {
                    "coulomb_torque": Sane(0.0, 0.6, "as dry friction"),
                    "extra_torque": Sane(0.0, 0.6, "as dry friction"),
                    "share": Sane(0.0, 0.7, "plastic and metal spur gears"),
                    "extra_share": Sane(0.0, 0.7, "plastic and metal spur gears"),
                }.items()
            },
            "torque_offset.torque": Sane(-0.3, 0.3, "a tenth of the stall torque"),
            "backlash.gap": Sane(0.0, 0.03, "data sheet: 0.5 degrees, worn more"),
            "armature.inertia": Sane(0.0, 0.05, "BAM: 0.028 kg m^2"),
            "encoder_offset.offset": Sane(-0.2, 0.2, "homed by hand"),
            "command_latency.delay": Sane(0.0, 0.06, "three ticks of 20 ms"),
            "sensor_delay.delay": Sane(0.0, 0.06, "three ticks of 20 ms"),
            "torque_limit.torque": Sane(0.3, _SO101_LIMIT, "below the stall torque"),
            "speed_limit.speed": Sane(0.5, 8.0, "about the no-load speed"),
            "joint_spring.stiffness": Sane(0.0, 0.5, "a bundle of cables"),
        },
    ),
    "emps": RealRobot(
        title="EMPS: friction behind a closed position loop, and pulses",
        folder="emps",
        model="emps.xml",
        source="nonlinearbenchmark.org (EMPS)",
        about="""A real ball-screw axis at 1 kHz (nonlinearbenchmark.org): reference,
position and motor force of two runs; in the second, force pulses were added at the
actuator. The model is its mass of 95.11 kg and its documented controller. In closed
loop the position hardly shows friction: the measured motor force drives the model, and
its controller only says where the pulses are.""",
        drive="torques",
        least_share=0.001,
        published=(
            Published("coulomb_friction", "torque", 20.39, "Coulomb friction [N]"),
            Published(
                "viscous_friction", "coefficient", 203.5, "viscous friction [N s/m]"
            ),
            Published("torque_offset", "torque", 3.16, "constant force [N]"),
        ),
        pulses=25,
    ),
    "go2": RealRobot(
        title="Go2 in the air: a verdict with its doubts",
        folder="go2",
        model="go2",
        source="iit-DLSLab/sim2real-robot-identification (BSD-3)",
        about="""One recording of a real Unitree Go2 held in the air (BSD-3): positions
and their targets at 200 Hz, spaced evenly after the fact. The model is `go2.urdf` of
example-robot-data, its base fixed and level, with the stated joint servos.""",
        gains=ServoGains(20.0, 1.5, 23.7),
    ),
}
"""The real robots by their names on the command line.

Example:
  >>> sorted(ROBOTS)
  ['emps', 'go2', 'so101']
"""
