"""What a concealed case is: plant, engine, effects, sensors; drawn from (seed, i).

Nothing is drawn that could not be told even from perfect recordings: effects only
where they differ from all others (`experiments.concealed.where`), and two together
only if they are not one and the same (`APART`). In pairs and triples sizes are from the
easier half, so that every one of them matters.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from worlds.hidden import (
    KINDS,
    Hidden,
    HiddenPlant,
    Scales,
    Setting,
    Spot,
)
from worlds.hidden.recorded import HiddenSensors

PLANTS = {
    "pendulum": 0.25,
    "so101": 0.30,
    "nao_air": 0.30,
    "nao_standing": 0.10,
    "nao_walking": 0.05,
}
"""How often each is drawn."""
CASE_KINDS = {
    "single": 0.45,
    "pair": 0.15,
    "triple": 0.05,
    "none": 0.15,
    "outside": 0.10,
    "unexcited": 0.10,
}
"""How often each is drawn."""
CONFUSABLE = (
    ("coulomb_friction", "backlash"),
    ("command_latency", "viscous_friction"),
    ("payload_mass", "servo_gain"),
    ("ground_slope", "encoder_offset"),
    ("contact_friction", "contact_compliance"),
)
_CONFUSABLE_SHARE = 0.6
_COMPOUND_EASE = 0.5
_QUANTA_RAD = (0.0015, 2 * np.pi / 2**14)
_COUNT = {"single": 1, "unexcited": 1, "outside": 1, "pair": 2, "triple": 3, "none": 0}


@dataclass(frozen=True)
class CaseSort:
    """What is settled before anything is simulated."""

    plant: str
    kind: str
    engine: str

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "CaseSort":
        """Plant and kind by their shares; unexcited joints need a fixed base."""
        plant = str(rng.choice(list(PLANTS), p=list(PLANTS.values())))
        kind = str(rng.choice(list(CASE_KINDS), p=list(CASE_KINDS.values())))
        if kind == "unexcited" and plant in ("nao_standing", "nao_walking"):
            plant = "nao_air"
        return cls(plant, kind, str(rng.choice(["bullet", "mujoco"])))


@dataclass(frozen=True, eq=False)
class Concealed:
    """What is hidden in a case, and how easy it is to see, at most 1."""

    effects: tuple[Hidden, ...]
    ease: float


def drawn_sensors(kind: str, rng: np.random.Generator) -> tuple[HiddenSensors, float]:
    """Sensors of a case, and the most by which its ticks are off [s].

    With nothing missing the noise may be up to three times as strong.
    """
    stronger = float(rng.uniform(1.0, 3.0)) if kind == "none" else 1.0
    sensors = HiddenSensors(
        quantum_rad=float(rng.choice(_QUANTA_RAD, p=[0.7, 0.3])),
        encoder_rad=stronger * float(rng.uniform(0.0003, 0.0005)),
        gyroscope_rad_s=stronger * 0.004,
        accelerometer_m_s2=stronger * 0.06,
    )
    return sensors, float(np.exp(rng.uniform(np.log(1e-4), np.log(1e-3))))


def drawn_effects(
    sort: CaseSort,
    plant: HiddenPlant,
    scales: Scales,
    joints: Sequence[int],
    duration_s: float,
    rng: np.random.Generator,
    ease: float | None = None,
) -> Concealed:
    """What is hidden in a case.

    Args:
      sort: plant and kind.
      plant: the robot.
      scales: what it does with nothing hidden.
      joints: where effects may be.
      duration_s: of the recordings.
      rng: draws all of it.
      ease: how easy it is to see; drawn where None.
    """
    drawn = float(rng.uniform())
    if sort.kind in ("pair", "triple"):
        drawn = _COMPOUND_EASE + (1 - _COMPOUND_EASE) * drawn
    ease = drawn if ease is None else ease
    if sort.kind != "unexcited":
        joints = [j for j in joints if scales.moving[j]]
    there = {n: kind.spots(plant, scales, joints) for n, kind in KINDS.items()}
    known = [n for n in there if there[n] and sort.engine in KINDS[n].engines]
    names = _names(sort.kind, plant, known, rng)
    effects: list[Hidden] = []
    used: set[int] = set()
    for name in names:
        together = len(effects) == 1 and tuple(names[:2]) in CONFUSABLE
        spot = _spot(there[name], used, together, rng)
        used.add(spot.joint)
        setting = Setting(plant, scales, spot, ease, duration_s, rng)
        effects.append(Hidden.sized(name, setting))
    return Concealed(tuple(effects), ease)


def _spot(
    options: Sequence[Spot], used: set[int], together: bool, rng: np.random.Generator
) -> Spot:
    """One of the spots, if it can be at a joint that is used or at one that is not."""
    wanted = [spot for spot in options if (spot.joint in used) == together]
    wanted = wanted or list(options)
    return wanted[int(rng.integers(len(wanted)))]


def _names(
    kind: str, plant: HiddenPlant, known: Sequence[str], rng: np.random.Generator
) -> list[str]:
    if kind == "outside":
        return [str(rng.choice([name for name in known if KINDS[name].outside]))]
    if kind == "unexcited":
        return [str(rng.choice([name for name in known if KINDS[name].needs_motion]))]
    inside = [name for name in known if not KINDS[name].outside]
    names: list[str] = []
    if kind in ("pair", "triple") and rng.uniform() < _CONFUSABLE_SHARE:
        pairs = [pair for pair in CONFUSABLE if set(pair) <= set(inside)]
        names += pairs[int(rng.integers(len(pairs)))]
    while len(names) < _COUNT[kind]:
        name = str(rng.choice(inside))
        if name not in names and _compatible([*names, name], plant):
            names.append(name)
    return names


def _compatible(names: Sequence[str], plant: HiddenPlant) -> bool:
    """Whether these kinds can be distinguished from each other in one case."""
    return not any(KINDS[name].apart(plant) & set(names) for name in names)
