"""Makes a test case of set 2: draws, sizes and simulates it."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from experiments.concealed.motion import CaseMotion
from experiments.concealed.second.draw import Slot, drawn_slots
from experiments.concealed.second.information import MOST_NATS_2, Teller
from experiments.concealed.second.motion import SecondMotion
from experiments.concealed.second.nuisance import EXACT, Nuisance
from experiments.concealed.second.plan import CasePlan, planned
from experiments.concealed.size_by_information import drawn_nats, ease_that_tells
from experiments.concealed.written import SOURCE, MadeCase
from groundwalk.errors import GroundwalkError
from worlds.hidden import KINDS, Hidden
from worlds.hidden.recorded import Log, hidden_recording
from worlds.hidden.run import Run, run_hidden
from worlds.hidden.scales import scales
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording

REFERENCE_MOTIONS = (0, 2)
"""Indices of the motions that are recorded of the healthy robot, too."""
TRIAL_STEP_S, STIFF_STEP_S = 0.002, 0.0005
"""Physics steps [s] in the search for an effect's size: coarse, and therefore fast; the
second one for springs and gear teeth."""
TRIAL_HZ = 125.0
"""Highest tick rate [Hz] in the search for an effect's size; more tells no more."""
_ATTEMPTS = 40
"""Largest number of times that a test case is drawn before it is given up."""


def second_case(seed: int, number: int, count: int) -> MadeCase:
    """Make test case `number` of set 2 with this seed and number of cases.

    GroundwalkError if in every attempt the simulation diverged, or no size of an effect
    was as visible in the recordings as the level that was drawn demands.
    """
    plan = planned(seed, count)[number]
    for attempt in range(_ATTEMPTS):
        maker = _Maker(plan, [seed, number, attempt])
        if maker.run():
            return maker.made()
    raise GroundwalkError(
        f"case {number} of seed {seed}: in every attempt the simulation diverged, or "
        "the effect hardly showed"
    )


class _Maker:
    """One attempt to make a test case as it is planned."""

    def __init__(self, plan: CasePlan, seed: Sequence[int]) -> None:
        self._plan, self._seed = plan, list(seed)
        self._drawn = SecondMotion.drawn(plan, self._rng(0))
        self._noise = self._rng(1)
        self._effects: tuple[Hidden, ...] = ()
        self._nats: tuple[float, ...] = ()

    def _rng(self, part: int) -> np.random.Generator:
        return np.random.default_rng([*self._seed, part])

    def run(self) -> bool:
        """Simulate all motions; False if one diverged or no effect size fits."""
        motion, plan = self._drawn.motion, self._plan
        self._step_s = TRIAL_STEP_S
        nominal = self._trial(0, EXACT, ())
        if not nominal.ok:
            return False
        self._scales = scales(motion.plants[0], [nominal])
        slots = drawn_slots(plan, motion.plant, self._scales, [*self._seed, 2])
        torques = plan.drive == "torques"
        whole = Nuisance.drawn(motion.plant, self._scales, torques, self._rng(3))
        self._nuisance = whole.beside([slot.at(motion.plant) for slot in slots])
        if slots and not self._sized(slots, whole):
            return False
        own = self._nuisance
        numbers = range(len(motion.names))
        self._runs = [self._move(motion, i, own, self._effects) for i in numbers]
        healthy = REFERENCE_MOTIONS if plan.reference else ()
        self._before = [self._move(self._drawn.before, i, own, ()) for i in healthy]
        return all(run.ok for run in [*self._runs, *self._before])

    def _sized(self, slots: Sequence[Slot], whole: Nuisance) -> bool:
        """Find the effects' sizes, each alone; False if there is none for one of them.

        Then the information on each is measured, all others given. The `whole` small
        mismatch decides what stands out, even where an effect replaces a part of it.
        """
        motion, own, rng = self._drawn.motion, self._nuisance, self._rng(4)
        stiff = any(KINDS[slot.name].stiff for slot in slots)
        self._step_s = STIFF_STEP_S if stiff else TRIAL_STEP_S
        exact, real, without = (self._trials(one, ()) for one in (EXACT, whole, own))
        if not all(run.ok for run in [*exact, *real, *without]):
            return False
        teller = self._teller().beside(exact, real)

        def tells(ease: float, slot: Slot) -> float:
            one = slot.sized(motion.plant, self._scales, ease, motion.duration_s)
            return teller.nats(without, self._trials(own, [one]), [one])

        sized = list[Hidden]()
        for slot in slots:
            told = partial(tells, slot=slot)
            ease = ease_that_tells(
                drawn_nats(rng, MOST_NATS_2), told, float(rng.uniform())
            )
            if ease is None:
                return False
            sized.append(
                slot.sized(motion.plant, self._scales, ease, motion.duration_s)
            )
        every, nats = self._trials(own, sized), []
        for one in sized:
            others = [other for other in sized if other is not one]
            rest = self._trials(own, others) if others else without
            nats.append(teller.nats(rest, every, [one]))
        self._effects, self._nats = tuple(sized), tuple(nats)
        return all(math.isfinite(told) for told in nats)

    def _teller(self) -> Teller:
        return Teller(
            self._drawn.motion.plant,
            self._drawn.sensors,
            self._scales.inertia_kg_m2,
            self._trial_motion().rate_hz,
            self._plan.rate_hz,
            self._drawn.motion.jitter_s / math.sqrt(3),
            self._plan.drive == "torques",
        )

    def _trials(self, mismatch: Nuisance, effects: Sequence[Hidden]) -> list[Run]:
        """Simulate all motions in coarse physics steps."""
        names = self._drawn.motion.names
        return [self._trial(i, mismatch, effects) for i in range(len(names))]

    def _trial(self, number: int, mismatch: Nuisance, effects: Sequence[Hidden]) -> Run:
        motion = self._trial_motion()
        return self._moved(motion, number, mismatch, effects, self._step_s)

    def _trial_motion(self) -> CaseMotion:
        """The motions with fewer ticks and no jitter."""
        motion, rate_hz = self._drawn.motion, float(self._plan.rate_hz)
        fewer = rate_hz / math.ceil(rate_hz / TRIAL_HZ)
        return replace(motion, rate_hz=fewer, jitter_s=0.0)

    def _move(
        self,
        motion: CaseMotion,
        number: int,
        mismatch: Nuisance,
        effects: Sequence[Hidden],
    ) -> Run:
        """Simulate one motion; the rows of the run are those of the recording."""
        step_s, every = self._drawn.step_s, self._drawn.every
        return self._moved(motion, number, mismatch, effects, step_s).every(every)

    def _moved(
        self,
        motion: CaseMotion,
        number: int,
        mismatch: Nuisance,
        effects: Sequence[Hidden],
        step_s: float,
    ) -> Run:
        plant = motion.plants[number].with_masses(mismatch.extra_kg)
        clock = motion.clock(number, step_s)
        start_rad, feed = motion.feed(number)
        every = (*self._drawn.controller, *mismatch.effects, *effects)
        engine, nobody = self._plan.engine, np.random.SeedSequence(0)  # no ground
        paths = self._plan.drive == "torques"  # torques without steps at each tick
        return run_hidden(plant, every, engine, clock, feed, start_rad, nobody, paths)

    def made(self) -> MadeCase:
        """The case with its recordings, as noisy sensors make them, and its truth."""
        plant, names = self._drawn.motion.plant, self._drawn.motion.names
        recordings = {
            f"{i}_{names[i]}": self._recorded(run, i, self._effects)
            for i, run in enumerate(self._runs)
        }
        reference = {
            f"{i}_{names[i]}": self._recorded(run, i, ())
            for i, run in zip(REFERENCE_MOTIONS, self._before, strict=False)
        }
        return MadeCase(
            plant.name, plant.file, "fixed", recordings, reference, self.truth()
        )

    def _recorded(self, run: Run, number: int, effects: Sequence[Hidden]) -> Recording:
        plant, plan = self._drawn.motion.plants[number], self._plan
        torques = plan.drive == "torques"
        log = Log(plan.rate_hz, torques, self._nuisance.torque_gain)
        robot = plant.file[0] if plant.file else plant.name
        servo = {} if torques else plant.servo
        metadata = RecordingMetadata(robot, "fixed", SOURCE, servo=servo)
        sensors = self._drawn.sensors
        return hidden_recording(
            plant, run, effects, sensors, self._noise, metadata, log
        )

    def truth(self) -> dict[str, Any]:
        """The test case's entry in the sealed file."""
        plan, plant = self._plan, self._drawn.motion.plant
        return {
            "plant": plan.robot,
            "engine": plan.engine,
            "kind": plan.kind,
            "effects": [vars(effect) for effect in self._effects],
            "nats": self._nats,
            "nuisance": self._nuisance.told(plant, self._jitter_s()),
            "drive": plan.drive,
            "rate_hz": plan.rate_hz,
            "gains": plan.gains,
            "reference": plan.reference,
        }

    def _jitter_s(self) -> float:
        """Rms difference of the true and the recorded times."""
        off = []
        for run in self._runs:
            rows = np.arange(len(run.clock.ticks)) - run.clock.first
            wrong = run.clock.time_s - rows / self._plan.rate_hz
            off.append(wrong - wrong.mean())
        return float(np.std(np.concatenate(off)))
