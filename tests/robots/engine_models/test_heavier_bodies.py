import mujoco
import numpy as np
import pytest

from groundwalk.errors import BadValueError, UnknownNameError
from robots.engine_models.mjcf import scale_mass

ARM = """
<mujoco>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.1 0 -0.4" size="0.03" mass="{upper}"/>
      <body name="lower" pos="0.1 0 -0.4">
        <joint name="elbow" axis="1 1 0"/>
        <geom type="box" pos="0 0.05 -0.2" size="0.02 0.03 0.2" mass="{lower}"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def arm(upper=2.0, lower=0.5):
    model = mujoco.MjModel.from_xml_string(ARM.format(upper=upper, lower=lower))
    return model, mujoco.MjData(model)


def swing(model, data):
    """Where it is after a second."""
    mujoco.mj_resetData(model, data)
    data.qpos[:] = [0.7, -0.4]
    for _ in range(500):
        mujoco.mj_step(model, data)
    return data.qpos.copy()


@pytest.mark.parametrize(
    ("bodies", "masses"),
    [(("lower",), (2.0, 5.0)), ((), (20.0, 5.0))],
)
def test_it_is_the_model_whose_file_says_so(bodies, masses):
    scaled = arm()
    scale_mass(*scaled, 10.0, bodies)
    written = arm(*masses)
    constants = ("body_mass", "body_inertia", "body_subtreemass", "body_invweight0")
    for name in (*constants, "dof_invweight0", "dof_M0"):
        found, right = (getattr(model, name) for model, _ in (scaled, written))
        np.testing.assert_allclose(found, right, rtol=1e-12, err_msg=name)
    np.testing.assert_allclose(swing(*scaled), swing(*written), atol=1e-9)


def test_masses_alone_would_not_do():
    wrong, right = arm(), arm(lower=5.0)
    wrong[0].body_mass[2] *= 10
    assert np.abs(swing(*wrong) - swing(*right)).max() > 1e-3


def test_bad_values_are_refused():
    with pytest.raises(BadValueError, match="factor is 0"):
        scale_mass(*arm(), 0, ())
    with pytest.raises(UnknownNameError, match="did you mean 'lower'"):
        scale_mass(*arm(), 2, ("lowr",))
