"""What a law of physics sees of a physics step, and the base class of laws."""

from dataclasses import dataclass

import mujoco


@dataclass
class Joint:
    """A joint and its servo, whose torque is clip(kp error - kd speed, +-limit).

    Units are N m and rad, at a joint that slides N and m.

    Attributes:
      name: the joint's name, which is its actuator's, too.
      qpos: index in MuJoCo's position vector.
      dof: index in MuJoCo's velocity vector.
      actuator: index in MuJoCo's control vector.
      kp: stiffness of the servo [N m/rad].
      kd: damping inside of the torque limit [N m s/rad].
      limit: torque limit [N m]; infinite for none.
      constant: torque that always acts, as part of the actuator's [N m].
      back_emf: the servo's damping outside of the torque limit [N m s/rad], which
        corrected.xml has in the joint's damping.
      is_spring: whether the actuator stands for a spring instead of the servo.
      voltage: share of the supply's voltage that the servo has in this step.
      motor: angle [rad] and speed [rad/s] that the servo controls, after the last step;
        None if they are the joint's.
    """

    name: str
    qpos: int
    dof: int
    actuator: int
    kp: float
    kd: float
    limit: float
    constant: float
    back_emf: float
    is_spring: bool = False
    voltage: float = 1.0
    motor: tuple[float, float] | None = None

    @classmethod
    def of(cls, model: mujoco.MjModel, name: str, back_emf: float) -> "Joint":
        """Read a joint and its servo from the model."""
        actuator = model.actuator(name).id
        _, kp, kd = -model.actuator_biasprm[actuator, :3]
        constant = float(model.actuator_biasprm[actuator, 0])
        limited = model.actuator_forcelimited[actuator]
        limit = model.actuator_forcerange[actuator, 1] - constant
        return cls(
            name,
            int(model.joint(name).qposadr[0]),
            int(model.joint(name).dofadr[0]),
            actuator,
            float(kp),
            float(kd),
            float(limit) if limited else float("inf"),
            constant,
            back_emf,
        )


@dataclass
class Step:
    """One physics step of a model, before it is taken.

    Attributes:
      model: laws may change it, such as the friction of a joint.
      data: its state; laws add to `qfrc_applied` and `xfrc_applied`.
      targets: position target of each servo [rad], by the joint's name; laws change it.
      torques: torque of each motor that no servo drives [N m], by the joint's name.
      seconds: duration of the step.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    targets: dict[str, float]
    torques: dict[str, float]
    seconds: float


class Law:
    """One piece of physics that MuJoCo lacks, at one joint, body or sensor.

    Attributes:
      gyroscope_bias: what the gyroscope shows too much [rad/s], about its own axes.
    """

    gyroscope_bias: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def before_step(self, step: Step) -> None:
        """Change targets, forces or the model for the step that follows."""

    def position(self, joint: str) -> tuple[float, float] | None:
        """Angle [rad] and speed [rad/s] that a joint's encoder sees, if not its own."""
        return None
