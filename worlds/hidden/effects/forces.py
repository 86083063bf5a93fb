"""Hidden physics that is a force on one body: pushes and drag."""

import numpy as np

from groundwalk.gravity import GRAVITY_M_S2
from worlds.hidden.effects.kind import HiddenKind, Push, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Scales, Setting, Spot

_LASTING_SHARE = 0.3
"""Share of randomly drawn forces that act during the whole recording, where possible.
The others are short pushes."""


class ExternalForce(HiddenKind):
    """A constant force pushes a body's centre of mass for some time."""

    name = "external_force"
    rank = 25
    place = "body"
    quantities = (
        *(Quantity(axis, "N") for axis in "xyz"),
        Quantity("start", "s"),
        Quantity("duration", "s", 0.0),
    )

    def push(self, values: Values) -> Push:
        """Law of the force: constant in the world frame from start for its duration."""
        force_n = np.array([values[axis] for axis in "xyz"])
        start_s, duration_s = values["start"], values["duration"]
        return lambda time_s, velocity: (
            force_n if 0 <= time_s - start_s < duration_s else None
        )

    def size(self, s: Setting) -> dict[str, float]:
        """Force of 0.5 % (hard to detect) to 10 % (easy) of the moving parts' weight.

        It mostly acts for 0.05 to 0.5 s. A lasting force is only drawn where several
        joints move the body: elsewhere it could not be distinguished from a payload.
        """
        weight_n = s.scales.moving_kg * GRAVITY_M_S2
        way = s.across if len(s.plant.joints) == 1 else s.direction
        force = s.part(0.1, 0.005) * weight_n * way
        if s.many_joints and s.rng.uniform() < _LASTING_SHARE:
            span = {"start": 0.0, "duration": 1.5 * s.duration_s}
        else:
            start = s.rng.uniform(0.15, 0.8) * s.duration_s
            span = {"start": float(start), "duration": float(s.rng.uniform(0.05, 0.5))}
        return dict(zip("xyz", force.tolist(), strict=True)) | span

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the body moves; on a still one the force would show nowhere."""
        return scales.moves(spot.body)


class Drag(HiddenKind):
    """A force on a body, opposed and proportional to its velocity."""

    name = "drag"
    rank = 26
    place = "body"
    quantities = (Quantity("coefficient", "N s/m", 0.0),)

    def push(self, values: Values) -> Push:
        """Law of the force: -coefficient v, v the velocity of the centre of mass."""
        coefficient = values["coefficient"]
        return lambda time_s, velocity: -coefficient * velocity()

    def size(self, s: Setting) -> dict[str, float]:
        """Drag at 1 m/s of 2 % (hard to detect) to 40 % (easy) of the moving weight."""
        weight_n = s.scales.moving_kg * GRAVITY_M_S2
        return {"coefficient": s.part(0.4, 0.02) * weight_n}

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether several joints move the body; with one, drag is viscous friction."""
        many = plant.floating or scales.carriers(spot.body) > 1
        return scales.moves(spot.body) and many
