"""A robot with its hidden physics, loaded into a PyBullet client."""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from robots.model_urdf import model_urdf
from robots.sole import contact_points
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import HiddenPlant
from worlds.real.gear import couple
from worlds.real.silence import silent

if TYPE_CHECKING:
    import mujoco

_CONTACT_DAMPING = 0.1
"""Of the critical one, where a compliance does not say otherwise."""


def load_body(
    bullet: Any,
    client: dict[str, int],
    plant: HiddenPlant,
    model: "mujoco.MjModel",
    effects: Sequence[Hidden],
) -> int:
    """Load the robot, its joints free, without any damping that Bullet adds itself.

    Args:
      bullet: the module.
      client: names the physics client.
      plant: the nominal robot.
      model: the robot with what is hidden in its bodies.
      effects: what is hidden; the compliance of contacts is set here.

    Returns:
      The body's number.
    """
    body = _load(bullet, client, plant, model_urdf(model, plant.name))
    links = _links(bullet, client, body, plant)
    soles = np.flatnonzero(model.geom_contype == 1)
    friction = float(model.geom_friction[soles[0], 0]) if soles.size else 0.0
    for link in (-1, *links):
        bullet.changeDynamics(
            body,
            link,
            linearDamping=0,
            angularDamping=0,
            jointDamping=0,
            lateralFriction=friction,
            spinningFriction=0,
            rollingFriction=0,
            restitution=0,
            **client,
        )
    # Bullet's joints come with velocity motors that hold them still.
    bullet.setJointMotorControlArray(
        body, links, bullet.VELOCITY_CONTROL, forces=[0] * len(links), **client
    )
    _couple(bullet, client, body, plant, links)
    _soften(bullet, client, body, plant, links, effects)
    return body


def _load(bullet: Any, client: dict[str, int], plant: HiddenPlant, text: str) -> int:
    with tempfile.TemporaryDirectory() as folder, silent():
        path = Path(folder, "robot.urdf")
        path.write_text(text)
        return int(
            bullet.loadURDF(
                str(path),
                useFixedBase=not plant.floating,
                flags=bullet.URDF_USE_INERTIA_FROM_FILE,
                **client,
            )
        )


def _links(
    bullet: Any, client: dict[str, int], body: int, plant: HiddenPlant
) -> list[int]:
    """Bullet's numbers of the joints, in the plant's order."""
    rows = [
        bullet.getJointInfo(body, i, **client)
        for i in range(bullet.getNumJoints(body, **client))
    ]
    number = {row[1].decode(): int(row[0]) for row in rows}
    return [number[name] for name in plant.joints]


def _couple(
    bullet: Any,
    client: dict[str, int],
    body: int,
    plant: HiddenPlant,
    links: Sequence[int],
) -> None:
    """Gears between joints of one motor."""
    for first, second in plant.description.coupled if plant.description else ():
        couple(bullet, client, body, links[first], links[second])


def _soften(
    bullet: Any,
    client: dict[str, int],
    body: int,
    plant: HiddenPlant,
    links: Sequence[int],
    effects: Sequence[Hidden],
) -> None:
    """Springs under the soles; the points of a sole share a foot's stiffness."""
    if plant.description is None:
        return
    for effect in (e for e in effects if e.name == "contact_compliance"):
        stiffness, damping = effect["stiffness"], effect["damping"]
        if np.isnan(damping):
            load_kg = plant.description.mass_kg / 2
            damping = _CONTACT_DAMPING * 2 * np.sqrt(stiffness * load_kg)
        for foot in plant.description.feet:
            points = len(contact_points(foot))
            bullet.changeDynamics(
                body,
                links[foot.joint],
                contactStiffness=stiffness / points,
                contactDamping=damping / points,
                **client,
            )
