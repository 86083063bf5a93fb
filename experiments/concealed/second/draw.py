"""Draws which effects a case of set 2 hides and where; their sizes are found later."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from experiments.concealed.draw import CONFUSABLE, drawn_names
from experiments.concealed.second.plan import CasePlan
from worlds.hidden import KINDS, Hidden, HiddenPlant, Scales, Setting, Spot


@dataclass(frozen=True)
class Slot:
    """One hidden effect of a case without its size.

    All that is drawn with its size, such as signs, follows from the seed: an effect of
    another size is the same otherwise.
    """

    name: str
    spot: Spot
    seed: tuple[int, ...]

    def sized(
        self, plant: HiddenPlant, scales: Scales, ease: float, duration_s: float
    ) -> Hidden:
        """The effect as easy to see as `ease` says: 1 easiest, 0 hard, or below."""
        rng = np.random.default_rng(self.seed)
        setting = Setting(plant, scales, self.spot, ease, duration_s, rng)
        return Hidden.sized(self.name, setting)

    def at(self, plant: HiddenPlant) -> tuple[str, str]:
        """Name and place of the effect."""
        kind = KINDS[self.name]
        places = {"joint": plant.joints[self.spot.joint], "body": self.spot.body}
        return self.name, places.get(kind.place, kind.place)


def drawn_slots(
    plan: CasePlan,
    plant: HiddenPlant,
    scales: Scales,
    seed: Sequence[int],
) -> tuple[Slot, ...]:
    """Draw the names and places of a case's effects; () where nothing is hidden.

    They follow the rules of set 1: only effects that perfect recordings distinguish
    from all others, and each at a joint of its own, except for confusable pairs.
    """
    if plan.kind == "none":
        return ()
    rng = np.random.default_rng([*seed, 0])
    joints = [j for j in range(len(plant.joints)) if scales.moving[j]]
    spots = {
        name: kind.spots(plant, scales, joints)
        for name, kind in KINDS.items()
        if kind.since <= 2  # same draws for ever
        if plan.engine in kind.engines and (kind.in_torques or plan.drive == "servos")
    }
    known = [name for name in spots if spots[name]]
    names = drawn_names(plan.kind, plant, known, rng)
    slots, used = list[Slot](), set[int]()
    for number, name in enumerate(names):
        together = number == 1 and tuple(names[:2]) in CONFUSABLE
        wanted = [spot for spot in spots[name] if (spot.joint in used) == together]
        wanted = wanted or spots[name]
        spot = wanted[int(rng.integers(len(wanted)))]
        used.add(spot.joint)
        slots.append(Slot(name, spot, (*seed, number + 1)))
    return tuple(slots)
