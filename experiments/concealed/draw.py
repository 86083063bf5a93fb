"""Draws a test case with concealed physics: robot, engine, effects and sensors.

Only effects that perfect recordings would distinguish from all others are drawn: each
effect only at places where it differs from the other effects (its `spots`), and two
effects together only if their sum does not look like a third one (their `apart`). In
pairs and triples the sizes are from the larger half, so that each effect matters.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from worlds.hidden import KINDS, Hidden, HiddenPlant, Scales, Setting
from worlds.hidden.recorded import HiddenSensors

PLANTS = {
    "pendulum": 0.25,
    "so101": 0.30,
    "nao_air": 0.30,
    "nao_standing": 0.10,
    "nao_walking": 0.05,
}
"""Share of the test cases for each robot; a NAO is held in the air, stands or walks."""
CASE_KINDS = {
    "single": 0.45,
    "pair": 0.15,
    "triple": 0.05,
    "none": 0.15,
    "outside": 0.10,
    "unexcited": 0.10,
}
"""Share of the test cases for each kind: one, two, three or no hidden effects; one
effect that a diagnosis does not know ("outside"); one at a joint that is held still."""
CONFUSABLE = (
    ("coulomb_friction", "backlash"),
    ("command_latency", "viscous_friction"),
    ("payload_mass", "servo_gain"),
    ("ground_slope", "encoder_offset"),
    ("contact_friction", "contact_compliance"),
)
"""Pairs of effects that are hard to distinguish from each other."""
_CONFUSABLE_SHARE = 0.6
"""Share of the test cases with two or three effects that contain a pair of
`CONFUSABLE`."""
_COMPOUND_EASE = 0.5
"""Smallest ease (0 hard, 1 easy to see) of the effects in pairs and triples."""
_QUANTA_RAD = (0.0015, 2 * np.pi / 2**14)
"""Possible resolutions of the encoders [rad]: of 12 and of 14 bits per turn."""
_COUNT = {"single": 1, "unexcited": 1, "outside": 1, "pair": 2, "triple": 3, "none": 0}
"""Number of hidden effects by kind of test case."""


@dataclass(frozen=True)
class CaseSort:
    """Robot (key of `PLANTS`), kind (of `CASE_KINDS`) and engine of a test case."""

    plant: str
    kind: str
    engine: str

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> "CaseSort":
        """Draw robot, kind and engine; "unexcited" is drawn only with a fixed base."""
        plant = str(rng.choice(list(PLANTS), p=list(PLANTS.values())))
        kind = str(rng.choice(list(CASE_KINDS), p=list(CASE_KINDS.values())))
        if kind == "unexcited" and plant in ("nao_standing", "nao_walking"):
            plant = "nao_air"
        return cls(plant, kind, str(rng.choice(["bullet", "mujoco"])))


@dataclass(frozen=True, eq=False)
class Concealed:
    """The effects hidden in a test case, with their sizes.

    `ease` says how easy they are to see: 1 is easiest, 0 hard, below 0 even harder.
    """

    effects: tuple[Hidden, ...]
    ease: float


def drawn_sensors(kind: str, rng: np.random.Generator) -> tuple[HiddenSensors, float]:
    """Draw the sensors of a test case, and the largest error of its time stamps [s].

    For cases of the kind "none" the noise is up to three times as strong.
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
    """Draw the effects of a test case: their names, places (among `joints`) and sizes.

    `scales` are torques, speeds and ranges of the motion without hidden effects;
    `ease` says how easy the effects are to see, 0 to 1; None to draw it.
    """
    drawn = float(rng.uniform())
    if sort.kind in ("pair", "triple"):
        drawn = _COMPOUND_EASE + (1 - _COMPOUND_EASE) * drawn
    ease = drawn if ease is None else ease
    if sort.kind != "unexcited":
        joints = [j for j in joints if scales.moving[j]]
    there = {n: kind.spots(plant, scales, joints) for n, kind in KINDS.items()}
    old = [n for n, kind in KINDS.items() if kind.since == 1]  # same draws for ever
    known = [n for n in old if there[n] and sort.engine in KINDS[n].engines]
    names = drawn_names(sort.kind, plant, known, rng)
    effects: list[Hidden] = []
    used: set[int] = set()
    for name in names:
        # a confusable pair shares a joint; other effects have joints of their own
        together = len(effects) == 1 and tuple(names[:2]) in CONFUSABLE
        wanted = [spot for spot in there[name] if (spot.joint in used) == together]
        wanted = wanted or list(there[name])
        spot = wanted[int(rng.integers(len(wanted)))]
        used.add(spot.joint)
        setting = Setting(plant, scales, spot, ease, duration_s, rng)
        effects.append(Hidden.sized(name, setting))
    return Concealed(tuple(effects), ease)


def drawn_names(
    kind: str, plant: HiddenPlant, known: Sequence[str], rng: np.random.Generator
) -> list[str]:
    """Draw the names of the effects of a kind of case, from those that are possible."""
    if kind == "outside":
        return [str(rng.choice([name for name in known if KINDS[name].outside]))]
    if kind == "unexcited":
        return [str(rng.choice([name for name in known if KINDS[name].needs_motion]))]
    inside = [name for name in known if not KINDS[name].outside]
    names: list[str] = []
    if kind in ("pair", "triple") and rng.uniform() < _CONFUSABLE_SHARE:
        pairs = [pair for pair in CONFUSABLE if set(pair) <= set(inside)]
        if pairs:  # torques alone show none of them at some robots
            names += pairs[int(rng.integers(len(pairs)))]
    while len(names) < _COUNT[kind]:
        name = str(rng.choice(inside))
        if name not in names and _compatible([*names, name], plant):
            names.append(name)
    return names


def _compatible(names: Sequence[str], plant: HiddenPlant) -> bool:
    """Whether effects of these names can be told apart when they act together."""
    cancelling = [KINDS[name] for name in names if KINDS[name].cancels(plant)]
    return not any(set(kind.apart) & set(names) for kind in cancelling)
