"""All effects that a diagnosis can name."""

from diagnosis.effect import Effect
from diagnosis.effects.armature import Armature
from diagnosis.effects.backlash import Backlash
from diagnosis.effects.com_offset import ComOffset
from diagnosis.effects.command_latency import CommandLatency
from diagnosis.effects.contact_compliance import ContactCompliance
from diagnosis.effects.contact_friction import ContactFriction
from diagnosis.effects.coulomb_friction import CoulombFriction
from diagnosis.effects.drag import Drag
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
from groundwalk.errors import UnknownNameError

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
