"""Finds torques, accelerations and turning rates whose units cannot be right."""

import numpy as np

from diagnosis.audit.result import Finding
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2

_ABOVE, _FAR_ABOVE = 1.5, 20.0
"""Torques above the first multiple of the servo's limit are suspicious; above the
second, their unit is wrong."""
_IN_G = (0.7, 1.4)
"""A median size of the accelerometer's vector within this range, expected in m/s^2,
shows that the sensor reports multiples of gravity."""
_FASTEST_RAD_S = 35.0
"""Largest rate [rad/s] that robots' gyroscopes can measure: 2000 degrees a second."""


def torque_findings(trace: Trace, plant: Plant) -> list[Finding]:
    """Find measured and commanded torques far above the servos' limits."""
    found = []
    for quantity, values in (
        ("torque", trace.torque_nm),
        ("command_torque", trace.command_torque_nm),
    ):
        if values is None:
            continue
        for column, joint in enumerate(plant.joints):
            limit = float(trace.servo.max_torque_nm[column])
            most = float(_sizes(values[:, column]).max(initial=0.0))
            name = f"{quantity}.{joint}"
            said = f"{name} of {trace.name} reaches {most:.3g}"
            if most > _FAR_ABOVE * limit:
                text = f"{said}, far above the servo's {limit:.3g}; is its unit right?"
                found.append(Finding("refuse", text, trace.name, name))
            elif most > _ABOVE * limit:
                text = f"{said}, above the servo's {limit:.3g}"
                found.append(Finding("limit", text, trace.name, name))
    return found


def imu_findings(trace: Trace) -> list[Finding]:
    """Find accelerations in multiples of gravity, and turning rates in degrees."""
    found = []
    if trace.accelerometer_m_s2 is not None:
        norms = _sizes(np.linalg.norm(trace.accelerometer_m_s2, axis=1))
        norm = float(np.median(norms)) if len(norms) else GRAVITY_M_S2
        if _IN_G[0] < norm < _IN_G[1]:
            text = (
                f"accelerometer of {trace.name} shows {norm:.3g} where gravity is "
                f"{GRAVITY_M_S2} m/s^2; is it in g?"
            )
            found.append(Finding("refuse", text, trace.name, "accelerometer"))
    if trace.gyroscope_rad_s is not None:
        fastest = float(_sizes(trace.gyroscope_rad_s).max(initial=0.0))
        if fastest > _FASTEST_RAD_S:
            text = (
                f"gyroscope of {trace.name} reaches {fastest:.3g} rad/s, more than "
                "such sensors measure; is it in degrees per second?"
            )
            found.append(Finding("refuse", text, trace.name, "gyroscope"))
    return found


def _sizes(values: FloatArray) -> FloatArray:
    """(k,) absolute values of those that are not missing."""
    return np.asarray(np.abs(values[np.isfinite(values)]))
