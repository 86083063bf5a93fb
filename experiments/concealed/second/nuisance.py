"""The small mismatch that every robot of set 2 has, beside what is hidden in the case.

Real models are never exact. Masses, gains and the clock are a little wrong, and all
joints have some friction. None of this is the question of a case.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden import KINDS, Hidden, HiddenPlant, Scales, Setting, Spot

MASS_SHARE = (0.01, 0.03)
"""Range of the error of a body's mass, to either side, as a share of its mass."""
GAIN_SHARE = 0.05
"""Largest error of a servo's stiffness and damping, and of a measured torque."""
FRICTION_SHARE = (0.005, 0.015)
"""Range of dry friction, and of viscous friction at the highest speed, as shares of the
usual torque of a joint's servo."""


@dataclass(frozen=True, eq=False)
class Nuisance:
    """Small mismatch of a robot.

    Attributes:
      extra_kg: by body, how much heavier it is than the model says; < 0 if lighter.
      effects: wrong gains of the servos, and weak friction, at all joints.
      torque_gain: (j,) measured torques as multiples of the true ones; None where no
        torques are measured.
    """

    extra_kg: dict[str, float]
    effects: tuple[Hidden, ...]
    torque_gain: FloatArray | None

    @classmethod
    def drawn(
        cls, plant: HiddenPlant, scales: Scales, torques: bool, rng: np.random.Generator
    ) -> "Nuisance":
        """Draw the mismatch of a robot whose usual torques and speeds are `scales`.

        If `torques` are measured by an unknown controller, there are no known gains
        that could be wrong; the measured torques are.
        """
        model, j = plant.make_spec().compile(), len(plant.joints)
        own_kg = np.array([float(model.body(name).mass[0]) for name in plant.links])
        sign = rng.choice([-1.0, 1.0], j)
        extra_kg = sign * rng.uniform(*MASS_SHARE, j) * own_kg
        factors = rng.uniform(1 - GAIN_SHARE, 1 + GAIN_SHARE, (2, j))
        shares = rng.uniform(*FRICTION_SHARE, (2, j))
        effects = []
        for i, joint in enumerate(plant.joints):
            usual = Setting(plant, scales, Spot(i, plant.links[i]), 0.0, 0.0, rng)
            dry_nm, viscous_nm = (shares[:, i] * usual.torque_nm).tolist()
            viscous = viscous_nm / usual.speed_rad_s
            effects += [
                Hidden("coulomb_friction", joint, {"torque": dry_nm}),
                Hidden("viscous_friction", joint, {"coefficient": viscous}),
            ]
            if not torques:
                names = "servo_gain", "servo_damping"
                for name, factor in zip(names, factors[:, i].tolist(), strict=True):
                    effects.append(Hidden(name, joint, {"factor": factor}))
        extra = dict(zip(plant.links, extra_kg.tolist(), strict=True))
        return cls(extra, tuple(effects), factors[0] if torques else None)

    def beside(self, hidden: Sequence[tuple[str, str]]) -> "Nuisance":
        """The mismatch without what hidden effects, by name and place, stand for.

        Where friction is hidden there is no weak friction of the same kind: a size that
        is found could otherwise belong to either, or be the sum.
        """
        taken = {(name, place) for name, place in hidden}
        taken |= {(o, place) for name, place in hidden for o in KINDS[name].apart}
        extra = {
            body: more
            for body, more in self.extra_kg.items()
            if ("payload_mass", body) not in taken
        }
        effects = [one for one in self.effects if (one.name, one.place) not in taken]
        return replace(self, extra_kg=extra, effects=tuple(effects))

    def told(self, plant: HiddenPlant, jitter_s: float) -> list[dict[str, object]]:
        """The mismatch for the sealed truth: names, places and values.

        The names are those that an answer may use. `jitter_s` is the rms error of the
        time stamps.
        """
        masses = [
            {"name": "payload_mass", "place": body, "parameters": {"mass": more}}
            for body, more in self.extra_kg.items()
        ]
        gains = [] if self.torque_gain is None else self.torque_gain.tolist()
        torques = [
            {"name": "torque_scale", "place": joint, "parameters": {"factor": gain}}
            for joint, gain in zip(plant.joints, gains, strict=bool(gains))
        ]
        clock = {
            "name": "time_jitter",
            "place": "clock",
            "parameters": {"spread": jitter_s},
        }
        return [*masses, *map(vars, self.effects), *torques, clock]


EXACT = Nuisance({}, (), None)
"""No mismatch at all."""
