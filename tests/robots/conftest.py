"""The NAO in both engines, compiled once."""

import pybullet
import pytest

from robots.engine_models.mjcf import mujoco_spec
from robots.engine_models.urdf import urdf


@pytest.fixture(scope="session")
def model(nao):
    """The MuJoCo model with its floating root."""
    return mujoco_spec(nao).compile()


@pytest.fixture(scope="session")
def fixed_model(nao):
    """The MuJoCo model, its torso frame fixed to the world's."""
    spec = mujoco_spec(nao)
    spec.delete(spec.joint("root"))
    return spec.compile()


@pytest.fixture(scope="session")
def bullet():
    """A PyBullet client with gravity; its id."""
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
    yield client
    pybullet.disconnect(client)


@pytest.fixture(scope="session")
def load_urdf(bullet, tmp_path_factory):
    """Function: a description's body in that client; with its root fixed or not."""

    def load(description, fixed=True):
        path = tmp_path_factory.mktemp("urdf") / "robot.urdf"
        path.write_text(urdf(description))
        return pybullet.loadURDF(
            str(path),
            useFixedBase=fixed,
            flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
            physicsClientId=bullet,
        )

    return load
