"""How large a concealed effect is: from easy to see to hard, for every kind.

The ranges are parts of what the nominal robot itself does in the same motions: of its
torques, speeds, masses, reach (`worlds.hidden.scales`).
"""

import math
from collections.abc import Callable

import numpy as np

from experiments.concealed.setting import Setting
from experiments.concealed.where import LEAST_LEVER_M
from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from worlds.hidden.effects import Hidden

Maker = Callable[[Setting], dict[str, float]]


def sized(name: str, setting: Setting) -> Hidden:
    """The effect at its place, as large as the setting says."""
    place, maker = _MAKERS[name]
    at = {
        "joint": setting.plant.joints[setting.joint],
        "body": setting.spot.body,
    }.get(place, place)
    return Hidden(name, at, maker(setting))


def _viscous(s: Setting) -> dict[str, float]:
    return {"coefficient": s.part(0.2, 0.02) * s.torque_nm / s.speed_rad_s}


def _stribeck(s: Setting) -> dict[str, float]:
    """Its peak at speeds that the joint goes through: else it is Coulomb's."""
    coulomb = s.part(0.1, 0.02) * s.torque_nm
    part = s.rng.uniform(math.log(0.03), math.log(0.3))
    return {
        "coulomb_torque": coulomb,
        "extra_torque": float(s.rng.uniform(0.5, 1.5)) * coulomb,
        "speed": math.exp(part) * s.speed_rad_s,
    }


def _elasticity(s: Setting) -> dict[str, float]:
    stiffness = s.part(50.0, 2000.0)
    critical = 2 * math.sqrt(stiffness * float(s.scales.inertia_kg_m2[s.joint]))
    return {
        "stiffness": stiffness,
        "damping": float(s.rng.uniform(0.01, 0.05) * critical),
    }


def _gyro(s: Setting) -> dict[str, float]:
    return _vector(s.part(0.05, 0.003) * s.direction)


def _vector(values: FloatArray) -> dict[str, float]:
    return dict(zip("xyz", values.tolist(), strict=True))


def _com(s: Setting) -> dict[str, float]:
    """Across the joint's axis: along it nothing would change for the joint.

    What is last in a chain gets longer or shorter; aside it would act as a turn of the
    whole link does, which is an encoder's offset.
    """
    size_m, arm_m = s.part(0.05, 0.003), s.scales.bodies.arm_m[s.joint]
    length_m = float(np.linalg.norm(arm_m))
    if s.at_end and length_m >= LEAST_LEVER_M:
        return _vector(s.sign * size_m * arm_m / length_m)
    return _vector(size_m * s.across)


def _damping(s: Setting) -> dict[str, float]:
    """Of a motor without any of its own, more back-EMF would be viscous friction."""
    part = s.part(0.4, 0.05)
    sign = s.sign if s.plant.kd_nm_s_rad[s.joint] > 0 else -1.0
    return {"factor": 1.0 + sign * part}


def _spring(s: Setting) -> dict[str, float]:
    low, high = s.scales.reach_rad[s.joint]
    return {
        "stiffness": s.part(0.3, 0.01) * float(s.plant.kp_nm_rad[s.joint]),
        "rest": float(s.rng.uniform(low, high)),
    }


def _stop(s: Setting) -> dict[str, float]:
    low, high = s.scales.reach_rad[s.joint]
    side, half = s.sign, (high - low) / 2
    return {
        "angle": float((low + high) / 2 + side * s.part(0.3, 0.9) * half),
        "side": side,
    }


def _slope(s: Setting) -> dict[str, float]:
    most_deg = 4.0 if s.plant.floating else 8.0
    tilt = math.radians(s.part(most_deg, 0.5))
    way = s.rng.uniform(0, 2 * math.pi)
    return {"pitch": tilt * math.cos(way), "roll": tilt * math.sin(way)}


def _push(s: Setting) -> dict[str, float]:
    """A shove; one that lasts only where it is no other weight of a single link."""
    weight_n = s.scales.moving_kg * GRAVITY_M_S2
    way = s.across if s.one_joint else s.direction
    force = s.part(0.1, 0.005) * weight_n * way
    if s.many_joints and s.rng.uniform() < 0.3:
        span = {"start": 0.0, "duration": 1.5 * s.duration_s}
    else:
        start = s.rng.uniform(0.15, 0.8) * s.duration_s
        span = {"start": float(start), "duration": float(s.rng.uniform(0.05, 0.5))}
    return _vector(force) | span


def _drag(s: Setting) -> dict[str, float]:
    weight_n = s.scales.moving_kg * GRAVITY_M_S2
    return {"coefficient": s.part(0.4, 0.02) * weight_n}


def _lugre(s: Setting) -> dict[str, float]:
    torque = s.part(0.3, 0.05) * s.torque_nm
    return {"torque": torque, "stiffness": torque / float(s.rng.uniform(0.03, 0.12))}


def _cogging(s: Setting) -> dict[str, float]:
    return {
        "torque": s.part(0.3, 0.03) * s.torque_nm,
        "per_turn": float(s.rng.integers(12, 60)),
        "phase": float(s.rng.uniform(0, 2 * math.pi)),
    }


def _crosstalk(s: Setting) -> dict[str, float]:
    others = [i for i in range(len(s.plant.joints)) if i != s.joint]
    return {
        "source": float(s.rng.choice(others)),
        "share": s.sign * s.part(0.2, 0.01),
    }


def _wave(s: Setting) -> dict[str, float]:
    return {
        "torque": s.part(0.2, 0.02) * s.torque_nm,
        "frequency": float(s.rng.uniform(0.7, 6.0)),
        "phase": float(s.rng.uniform(0, 2 * math.pi)),
    }


def _of_torque(name: str, easy: float, hard: float) -> Maker:
    return lambda s: {name: s.part(easy, hard) * s.torque_nm}


def _plain(name: str, easy: float, hard: float) -> Maker:
    return lambda s: {name: s.part(easy, hard)}


_MAKERS: dict[str, tuple[str, Maker]] = {
    "viscous_friction": ("joint", _viscous),
    "coulomb_friction": ("joint", _of_torque("torque", 0.15, 0.01)),
    "stribeck_friction": ("joint", _stribeck),
    "load_friction": ("joint", _plain("share", 0.3, 0.03)),
    "backlash": ("joint", _plain("gap", 0.06, 0.003)),
    "joint_elasticity": ("joint", _elasticity),
    "command_latency": ("commands", _plain("delay", 0.06, 0.002)),
    "sensor_delay": ("encoders", _plain("delay", 0.04, 0.002)),
    "encoder_offset": ("joint", lambda s: {"offset": s.sign * s.part(0.1, 0.005)}),
    "gyro_bias": ("gyroscope", _gyro),
    "torque_limit": (
        "joint",
        lambda s: {"torque": s.part(0.4, 0.9) * float(s.scales.peak_nm[s.joint])},
    ),
    "speed_limit": (
        "joint",
        lambda s: {"speed": s.part(0.4, 0.9) * s.speed_rad_s},
    ),
    "servo_gain": (
        "joint",
        lambda s: {"factor": 1.0 + s.sign * s.part(0.4, 0.03)},
    ),
    "servo_damping": ("joint", _damping),
    "armature": (
        "joint",
        lambda s: {"inertia": s.part(3, 0.1) * float(s.scales.inertia_kg_m2[s.joint])},
    ),
    "payload_mass": (
        "body",
        lambda s: {"mass": s.part(0.3, 0.01) * float(s.scales.carried_kg[s.joint])},
    ),
    "com_offset": ("body", _com),
    "joint_spring": ("joint", _spring),
    "end_stop": ("joint", _stop),
    "servo_fade": ("joint", lambda s: {"rate": s.part(0.25, 0.03) / s.duration_s}),
    "contact_friction": ("feet", _plain("coefficient", 0.2, 0.6)),
    "contact_compliance": ("feet", _plain("stiffness", 3000.0, 40000.0)),
    "ground_slope": ("world", _slope),
    "uneven_ground": ("world", _plain("height", 0.008, 0.0007)),
    "external_force": ("body", _push),
    "drag": ("body", _drag),
    "lugre_hysteresis": ("joint", _lugre),
    "cogging": ("joint", _cogging),
    "joint_crosstalk": ("joint", _crosstalk),
    "periodic_torque": ("joint", _wave),
}
