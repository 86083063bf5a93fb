"""All effects that a diagnosis can name."""

import contextlib
from collections.abc import Iterator

from diagnosis.effects.armature import Armature
from diagnosis.effects.backlash import Backlash
from diagnosis.effects.com_offset import ComOffset
from diagnosis.effects.command_latency import CommandLatency
from diagnosis.effects.contact_compliance import ContactCompliance
from diagnosis.effects.contact_friction import ContactFriction
from diagnosis.effects.coulomb_friction import CoulombFriction
from diagnosis.effects.drag import Drag
from diagnosis.effects.effect import Effect, PlacedEffect
from diagnosis.effects.encoder_offset import EncoderOffset
from diagnosis.effects.end_stop import EndStop
from diagnosis.effects.external_force import ExternalForce
from diagnosis.effects.ground_slope import GroundSlope
from diagnosis.effects.gyro_bias import GyroBias
from diagnosis.effects.joint_elasticity import JointElasticity
from diagnosis.effects.joint_spring import JointSpring
from diagnosis.effects.load_friction import LoadFriction
from diagnosis.effects.payload_mass import PayloadMass
from diagnosis.effects.sensor_delay import SensorDelay
from diagnosis.effects.servo_damping import ServoDamping
from diagnosis.effects.servo_fade import ServoFade
from diagnosis.effects.servo_gain import ServoGain
from diagnosis.effects.speed_limit import SpeedLimit
from diagnosis.effects.stribeck_friction import StribeckFriction
from diagnosis.effects.torque_limit import TorqueLimit
from diagnosis.effects.uneven_ground import UnevenGround
from diagnosis.effects.viscous_friction import ViscousFriction
from groundwalk.errors import BadValueError, UnknownNameError

EFFECTS: dict[str, Effect] = {
    one.name: one
    for one in (
        ViscousFriction(),
        CoulombFriction(),
        StribeckFriction(),
        LoadFriction(),
        Backlash(),
        JointElasticity(),
        CommandLatency(),
        SensorDelay(),
        EncoderOffset(),
        GyroBias(),
        TorqueLimit(),
        SpeedLimit(),
        ServoGain(),
        ServoDamping(),
        Armature(),
        PayloadMass(),
        ComOffset(),
        JointSpring(),
        EndStop(),
        ServoFade(),
        ContactFriction(),
        ContactCompliance(),
        GroundSlope(),
        UnevenGround(),
        ExternalForce(),
        Drag(),
    )
}
"""By name; friction and gears, signals, servos, bodies, joints, ground, outside."""


def effect(name: str) -> Effect:
    """The effect of a name.

    Raises:
      UnknownNameError: there is none.
    """
    if name not in EFFECTS:
        raise UnknownNameError("effect", name, EFFECTS)
    return EFFECTS[name]


def grown_from(placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
    """Effects at the same place that contain this one: where to begin with each."""
    return tuple(one for kind in EFFECTS.values() for one in kind.grown_from(placed))


@contextlib.contextmanager
def also_known(*effects: Effect) -> Iterator[None]:
    """Let diagnoses within this block name effects of your own, too.

        with also_known(WaterDrag()):
            found = diagnose(plant, traces, seed)

    They count for the whole process as long as the block lasts, and are told about
    within it: a verdict that names them needs them for its words.

    Args:
      *effects: objects of subclasses of `Effect`, or of a base in `diagnosis.effects`.

    Raises:
      BadValueError: the name is another effect's.
    """
    for one in effects:
        if one.name in EFFECTS:
            raise BadValueError(f"there is an effect {one.name!r}; choose another name")
    EFFECTS.update({one.name: one for one in effects})
    try:
        yield
    finally:
        for one in effects:
            EFFECTS.pop(one.name, None)
