"""Torques that a motion needs: against a pendulum's equation of motion."""

import numpy as np
import pytest

from robots.engine_models.inverse_dynamics import InverseDynamics

MASS_KG, LENGTH_M, INERTIA, DAMPING, DRY_NM, ROTOR = 0.8, 0.3, 0.004, 0.05, 0.02, 0.003
PENDULUM = f"""<mujoco><worldbody><body name="link">
<joint name="axis" axis="0 1 0" damping="{DAMPING}" frictionloss="{DRY_NM}"
 armature="{ROTOR}" range="-0.1 0.1"/>
<inertial pos="0 0 {-LENGTH_M}" mass="{MASS_KG}"
 diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
</body></worldbody>
<actuator><position joint="axis" kp="50"/></actuator></mujoco>"""


def test_a_pendulum_needs_what_its_equation_says():
    random = np.random.default_rng(0)
    q, v, a = random.normal(size=(3, 20, 1))
    found = InverseDynamics.of_text(PENDULUM).of(("axis",), q, v, a)
    inertia = INERTIA + MASS_KG * LENGTH_M**2 + ROTOR
    weight = MASS_KG * 9.81 * LENGTH_M
    wanted = inertia * a + weight * np.sin(q) + DAMPING * v + DRY_NM * np.sign(v)
    assert found == pytest.approx(wanted, rel=1e-9)
