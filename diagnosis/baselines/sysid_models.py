"""Converts models and recordings to the form that mujoco.sysid expects."""

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

import mujoco
import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.scales import mass_kg
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.drive import Held
from diagnosis.replay.joint_friction import SOLIMP_FRICTION, stops_in_a_step
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

STEP_S = 0.002
"""Time step of the physics in simulations by mujoco.sysid."""


@dataclass(frozen=True)
class FreeParameter:
    """A parameter to be fitted: that of an effect at a place.

    Its value is `neutral` plus a count, from `low` to `high`, of typical sizes.
    """

    placed: PlacedEffect
    neutral: float
    size: float
    low: float
    high: float

    def value(self, count: float) -> float:
        """Parameter value in its own unit, `count` typical sizes from neutral."""
        return self.neutral + self.size * float(count)


def free_parameters(plant: Plant, traces: Sequence[Trace]) -> list[FreeParameter]:
    """All parameters to be fitted: those that users of mujoco.sysid usually fit.

    They belong to effects that MuJoCo can simulate, with one parameter of a joint or
    body, and without threshold: inertia, friction, stiffness, damping and mass. What
    differs from joint to joint, such as an encoder's zero, is not among them.
    Typical sizes are those for the servos of the first recording.
    """
    plant = replace(plant, servo=traces[0].servo)
    free = []
    for name, kind in all_effects().items():
        is_fixed_part = kind.place_kind in ("joint", "body")
        if not kind.native or kind.threshold or not is_fixed_part:
            continue
        if not kind.of_motor:
            continue
        for place in kind.places(plant, traces):
            parameter, *others = kind.parameters(plant, place)
            if others:
                break
            if kind.place_kind == "body":  # a mass, which users bound by the robot's
                parameter = replace(parameter, high=mass_kg(plant))
            size = abs(parameter.typical - parameter.neutral)
            low, high = (
                (bound - parameter.neutral) / size
                for bound in (parameter.low, parameter.high)
            )
            placed = PlacedEffect(name, place)
            free.append(FreeParameter(placed, parameter.neutral, size, low, high))
    return free


class SysidModels:
    """Makes models with given parameters by changing compiled ones, which is fast."""

    def __init__(
        self, plant: Plant, traces: Sequence[Trace], free: Sequence[FreeParameter]
    ) -> None:
        """Compile one model for each recording, since each has its own servos."""
        self._plant, self._free = plant, free
        self._nominal = {
            f"trace_{number}": (self._with_servo(trace.servo), trace.servo)
            for number, trace in enumerate(traces)
        }

    def build(self, parameters: Any, spec: mujoco.MjSpec) -> mujoco.MjModel:
        """Make a recording's model; its number is in the specification's name."""
        nominal, servo = self._nominal[spec.modelname]
        variants = Variants(self._plant, 1)
        for one, count in zip(self._free, parameters.as_vector(), strict=True):
            placed, value = one.placed, np.array([one.value(count)])
            effect(placed.name).apply(variants, 0, placed.place, value)
        model = copy.copy(nominal)
        self._change(model, servo, variants)
        mujoco.mj_setConst(model, mujoco.MjData(model))
        return model

    def _with_servo(self, servo: Servo) -> mujoco.MjModel:
        plant = self._plant
        model = copy.copy(plant.model)
        model.opt.timestep = STEP_S
        rows, limit = plant.actuators, servo.max_torque_nm
        model.actuator_gainprm[rows, 0] = servo.kp_nm_rad
        model.actuator_biasprm[rows, 1] = -servo.kp_nm_rad
        model.actuator_biasprm[rows, 2] = -servo.kd_nm_s_rad
        model.actuator_forcelimited[rows] = np.isfinite(limit)
        finite = np.where(np.isfinite(limit), limit, 0.0)
        model.actuator_forcerange[rows] = np.stack([-finite, finite], axis=1)
        emf = servo.back_emf_nm_s_rad - plant.servo.back_emf_nm_s_rad
        model.dof_damping[plant.dofs] += emf
        damping = model.dof_damping.copy()
        damping[plant.dofs] += servo.kd_nm_s_rad
        model.dof_solimp[:] = SOLIMP_FRICTION
        model.dof_solref[:] = stops_in_a_step(damping, model.dof_M0, STEP_S)
        return model

    def _change(self, model: mujoco.MjModel, servo: Servo, variants: Variants) -> None:
        """Write the only variant's effects into a model with a recording's servos."""
        plant, joints = self._plant, variants.joints
        for name, values in variants.fields.items():
            getattr(model, name)[...] += values[0] - getattr(plant.model, name)
        dofs, rows = plant.dofs, plant.actuators
        model.dof_frictionloss[dofs] += joints.coulomb_nm[0]
        model.actuator_gainprm[rows, 0] *= joints.kp_factor[0]
        model.actuator_biasprm[rows, 1] *= joints.kp_factor[0]
        model.actuator_biasprm[rows, 2] *= joints.damping_factor[0]
        more = joints.damping_factor[0] - 1
        model.dof_damping[dofs] += more * servo.back_emf_nm_s_rad


def sequence_of(sysid: ModuleType, plant: Plant, trace: Trace, number: int) -> Any:
    """Convert a recording to mujoco.sysid's `ModelSequences`.

    The name of its `MjSpec` is made from `number`. Positions are compared as part of
    the state, since position sensors in MuJoCo's rollout are one step late.
    """
    spec = plant.spec.copy()
    spec.modelname = f"trace_{number}"
    spec.option.timestep = STEP_S
    for sensor in list(spec.sensors):
        spec.delete(sensor)
    for joint in plant.joints:
        spec.add_sensor(
            name=f"{joint}_position",
            type=mujoco.mjtSensor.mjSENS_JOINTPOS,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=joint,
        )
    model = spec.compile()
    names = [(joint, sysid.SignalType.MjStateQPos) for joint in plant.joints]
    since_s = trace.time_s - trace.time_s[0]
    measured = sysid.TimeSeries.from_names(since_s, trace.position_rad, model, names)
    steps = int(np.ceil(since_s[-1] / STEP_S)) + 1
    times = np.asarray(STEP_S * np.arange(steps), float)
    control = sysid.TimeSeries.from_control_names(
        times, _control(plant, trace, model.nu, times), model
    )
    start = _start(sysid, plant, trace, model)
    return sysid.ModelSequences(
        spec.modelname, spec, trace.name, start, control, measured
    )


def _control(plant: Plant, trace: Trace, size: int, since_s: FloatArray) -> FloatArray:
    """Position targets (steps, size) [rad] at each step, held from row to row.

    Without commands these are the measured positions.
    """
    asked = trace.position_rad if trace.command_rad is None else trace.command_rad
    held = Held(trace.time_s, asked)
    control = np.zeros((len(since_s), size))
    control[:, plant.actuators] = held.mean(trace.time_s[0] + since_s, STEP_S)
    return control


def _start(
    sysid: ModuleType, plant: Plant, trace: Trace, model: mujoco.MjModel
) -> FloatArray:
    run = Run.of(trace)
    qpos, qvel = model.qpos0.copy(), np.zeros(model.nv)
    qpos[plant.qpos], qvel[plant.dofs] = run.position_rad, run.velocity_rad_s
    if plant.base == "floating" and trace.base_position_m is not None:
        qpos[:3] = trace.base_position_m[0]
        if trace.base_orientation is not None:
            qpos[3:7] = trace.base_orientation[0]
    return np.asarray(sysid.create_initial_state(model, qpos, qvel), float)
