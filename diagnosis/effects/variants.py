"""n variants of a plant: what effects change, one row each."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.plant.plant import Plant


@dataclass(frozen=True)
class Push:
    """A force on a body for some time.

    Attributes:
      body: its name.
      force_n: (x, y, z) in the world frame, at the body's centre of mass.
      start_s: in the trace's time.
      duration_s: how long.
    """

    body: str
    force_n: tuple[float, float, float]
    start_s: float
    duration_s: float


@dataclass(eq=False)
class Joints:
    """What the servos and joints of n variants do, arrays (n, j); neutral at first.

    Attributes:
      kp_factor: of the servo's stiffness.
      damping_factor: of the servo's damping and back-EMF.
      fade_1_s: the stiffness loses this share of itself each second.
      max_torque_nm: a limit besides the servo's own.
      setpoint_speed_rad_s: the set-point moves no faster.
      gap_rad: play between servo and joint; the servo does not feel errors within it.
      offset_rad: measured less true position; the servo acts on what is measured.
      coulomb_nm: friction torque.
      stribeck_nm: more of it near standstill ...
      stribeck_speed_rad_s: ... until about this speed.
      load_share: friction torque as a share of the servo's, back-EMF included.
      spring_nm_rad: stiffness between motor and joint; infinite if there is none.
      spring_damping_nm_s_rad: its damping.
    """

    kp_factor: FloatArray
    damping_factor: FloatArray
    fade_1_s: FloatArray
    max_torque_nm: FloatArray
    setpoint_speed_rad_s: FloatArray
    gap_rad: FloatArray
    offset_rad: FloatArray
    coulomb_nm: FloatArray
    stribeck_nm: FloatArray
    stribeck_speed_rad_s: FloatArray
    load_share: FloatArray
    spring_nm_rad: FloatArray
    spring_damping_nm_s_rad: FloatArray

    @classmethod
    def neutral(cls, n: int, j: int) -> "Joints":
        """As the plant is."""

        def full(value: float) -> FloatArray:
            return np.full((n, j), value)

        return cls(
            kp_factor=full(1.0),
            damping_factor=full(1.0),
            fade_1_s=full(0.0),
            max_torque_nm=full(np.inf),
            setpoint_speed_rad_s=full(np.inf),
            gap_rad=full(0.0),
            offset_rad=full(0.0),
            coulomb_nm=full(0.0),
            stribeck_nm=full(0.0),
            stribeck_speed_rad_s=full(0.1),
            load_share=full(0.0),
            spring_nm_rad=full(np.inf),
            spring_damping_nm_s_rad=full(0.0),
        )


@dataclass(eq=False)
class Signals:
    """What happens to signals between robot and computer, arrays (n, ...).

    Attributes:
      command_delay_s: (n,) until a command takes effect.
      sensor_delay_s: (n,) age of measured positions and velocities.
      gyro_bias_rad_s: (n, 3) added to the gyroscope.
    """

    command_delay_s: FloatArray
    sensor_delay_s: FloatArray
    gyro_bias_rad_s: FloatArray

    @classmethod
    def neutral(cls, n: int) -> "Signals":
        """As the plant is."""
        return cls(np.zeros(n), np.zeros(n), np.zeros((n, 3)))


@dataclass(eq=False)
class Outside:
    """What acts from outside on n variants.

    Attributes:
      pushes: for each variant.
      drag_n_s_m: (n, bodies) force against a body's velocity; MuJoCo's body order.
      bump_height_m: (n,) amplitude of uneven ground.
    """

    pushes: list[list[Push]]
    drag_n_s_m: FloatArray
    bump_height_m: FloatArray


class Variants:
    """n copies of a plant, each changed in its own way.

    Besides `joints`, `signals` and `outside` any field of the MuJoCo model can be
    changed: `field("dof_damping")[row, dof] += 0.1`.
    """

    def __init__(self, plant: "Plant", n: int) -> None:
        """N rows that are the plant itself."""
        self.plant = plant
        self.n = n
        self.joints = Joints.neutral(n, len(plant.joints))
        self.signals = Signals.neutral(n)
        self.outside = Outside(
            [[] for _ in range(n)], np.zeros((n, plant.model.nbody)), np.zeros(n)
        )
        self.fields: dict[str, FloatArray] = {}

    def field(self, name: str) -> FloatArray:
        """(n, ...) values of a field of the MuJoCo model, to be changed in place.

        Args:
          name: as `mujoco.batch.MODEL_FIELDS` has it, for example "opt.gravity".
        """
        if name not in self.fields:
            value = self.plant.model
            for part in name.split("."):
                value = getattr(value, part)
            nominal = np.asarray(value, float)
            self.fields[name] = np.repeat(nominal[None], self.n, axis=0)
        return self.fields[name]

    def column(self, joint: str) -> int:
        """Column of a joint in arrays (n, j)."""
        return self.plant.joints.index(joint)

    def dof(self, joint: str) -> int:
        """Degree of freedom of a joint."""
        return self.plant.dofs[self.column(joint)]

    def body(self, name: str) -> int:
        """MuJoCo's number of a body."""
        return int(self.plant.model.body(name).id)
