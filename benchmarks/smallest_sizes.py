"""Study: are the smallest sizes right that `groundwalk check` states?

Small robots are recorded in the hidden world, exact and with nothing hidden. `check`
says from these recordings which size of each effect it would tell. Then one effect is
hidden, with twice or half that size, beside the small mismatch that every robot has,
and the same commands are recorded and diagnosed. An effect is found if the verdict
names it at its place, and nothing as possible instead but twins, which `check` says
cannot be told apart.

    python -m benchmarks.smallest_sizes --cases 40 --seed 1 --out sizes.jsonl

Each case is a line of JSON in the file `out`; cases that are there are not repeated.
"""

import json
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from diagnosis import Plant, Trace, diagnose, load_plant
from diagnosis.check import check
from diagnosis.check.result import Size
from diagnosis.conclude.effect_sizes import scaled
from diagnosis.effects import PlacedEffect, effect
from diagnosis.effects.controllers import ON_S
from diagnosis.traces.read import trace_of
from diagnosis.verdict import Verdict
from experiments.command_line import run_script
from experiments.concealed.motion import CaseMotion
from experiments.concealed.second.nuisance import EXACT, Nuisance
from experiments.motions import MOTIONS
from groundwalk.arrays import FloatArray
from groundwalk.files import write_text
from worlds.hidden import KINDS, Hidden
from worlds.hidden.engine import BodySense
from worlds.hidden.limbs import limb_plant
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import Run, run_hidden
from worlds.hidden.scales import scales
from worlds.recordings.metadata import RecordingMetadata

ROBOTS = ("two_dof", "double_pendulum", "a1_leg")
RATE_HZ, DURATION_S, BEFORE_S = 100.0, 4.0, 0.5
STEP_S = 0.0005
"""Physics step of the hidden world [s]."""
SHARES = (2.0, 0.5)
"""Sizes that are hidden, as multiples of the smallest one that would be told."""


@dataclass(frozen=True, eq=False)
class Case:
    """One robot with its motions; everything random follows from `seed`."""

    seed: tuple[int, ...]
    motion: CaseMotion
    plant: Plant
    sensors: HiddenSensors

    @classmethod
    def drawn(cls, seed: Sequence[int], folder: Path) -> "Case":
        """Draw robot, motions and sensors."""
        rng = np.random.default_rng([*seed, 0])
        robot = limb_plant(ROBOTS[int(rng.integers(len(ROBOTS)))])
        low, high = robot.range_rad.T
        motion = CaseMotion(
            plant=robot,
            plants=(robot,) * len(MOTIONS),
            names=MOTIONS,
            places=tuple(range(len(low))),
            moves=np.ones(len(low), bool),
            centre_rad=low
            + (0.5 + 0.4 * rng.uniform(-0.5, 0.5, len(low))) * (high - low),
            rate_hz=RATE_HZ,
            spans_s=((BEFORE_S, DURATION_S),) * len(MOTIONS),
            jitter_s=0.0,
            seeds=tuple(int(one) for one in rng.integers(2**32, size=len(MOTIONS))),
        )
        assert robot.file is not None
        path = folder / f"{robot.name}.{robot.file[0]}"
        write_text(path, robot.file[1])
        plant = load_plant(path, "fixed", robot.joints, robot.servo)
        noise = float(np.exp(rng.uniform(np.log(5e-5), np.log(5e-4))))
        return cls(tuple(seed), motion, plant, HiddenSensors(0.0, noise))

    def runs(self, mismatch: Nuisance, effects: Sequence[Hidden]) -> list[Run]:
        """All motions of the robot with some mismatch and hidden effects."""
        return [self._run(i, mismatch, effects) for i in range(len(MOTIONS))]

    def _run(self, number: int, mismatch: Nuisance, effects: Sequence[Hidden]) -> Run:
        robot = self.motion.plant.with_masses(mismatch.extra_kg)
        start_rad, feed = self.motion.feed(number)
        every, nobody = (*mismatch.effects, *effects), np.random.SeedSequence(0)
        # only servos that integrate remember for how long they have been on
        remembers = any(one.name == "integral_term" for one in effects)
        held_s = ON_S if remembers else 0.0
        ticks = round(held_s * RATE_HZ)
        spans_s = tuple((held_s + before, own) for before, own in self.motion.spans_s)
        clock = replace(self.motion, spans_s=spans_s).clock(number, STEP_S)

        def held(row: int, sense: BodySense) -> FloatArray:
            return feed(max(row - ticks, 0), sense)

        return run_hidden(robot, every, "mujoco", clock, held, start_rad, nobody)

    def traces(self, runs: Sequence[Run], effects: Sequence[Hidden]) -> list[Trace]:
        """What noisy sensors make of the runs."""
        robot = self.motion.plant
        rng = np.random.default_rng([*self.seed, 1, len(effects)])
        metadata = RecordingMetadata(robot.name, "fixed", "study", servo=robot.servo)
        own = [
            hidden_recording(robot, run, effects, self.sensors, rng, metadata)
            for run in runs
        ]
        made = [
            trace_of(one, self.plant, name)
            for one, name in zip(own, MOTIONS, strict=True)
        ]
        return [replace(one, servo=self.plant.servo) for one in made]


def hidden_of(plant: Plant, size: Size, share: float) -> Hidden | None:
    """The effect with a multiple of its smallest size; None if it cannot have it."""
    kind = effect(size.name)
    every = kind.parameters(plant, size.place)
    placed = PlacedEffect(size.name, size.place, tuple(size.values.values()))
    wanted = scaled(plant, placed, share)
    back = scaled(plant, wanted, 1 / share)
    if not np.allclose(back.values, placed.values, rtol=1e-6):
        return None  # beyond its bounds
    values = {one.name: v for one, v in zip(every, wanted.values, strict=True)}
    known = KINDS[size.name].parameters
    return Hidden(
        size.name, size.place, {k: v for k, v in values.items() if k in known}
    )


def is_found(plant: Plant, verdict: Verdict, hidden: Hidden) -> tuple[bool, bool]:
    """Whether an effect is named at its place, and whether nothing else may be it.

    Nothing but its twins, which no recording of the robot tells apart from it.
    """
    twins = effect(hidden.name).twins(plant, hidden.place)
    known = {f"{one.name}@{one.place}" for one in twins}
    key = f"{hidden.name}@{hidden.place}"
    for one in verdict.effects if verdict.kind == "effects" else ():
        if f"{one.name}@{one.place}" == key:
            others = {f"{each.name}@{each.place}" for each in one.confusable_with}
            return True, not others - known
    return False, False


def cases_of(seed: int, number: int, folder: Path) -> dict[str, Any] | None:
    """Make and diagnose one case; None if the effect drawn has no such size."""
    begun_s = time.process_time()
    case = Case.drawn((seed, number), folder)
    exact = case.runs(EXACT, ())
    found = check(case.plant, case.traces(exact, ()), threads=1)
    rng = np.random.default_rng([seed, number, 2])
    names = sorted({one.name for one in found.sizes if one.name in KINDS})
    rng.shuffle(names)
    share = SHARES[number % 2]
    for name in names:
        own = [one for one in found.sizes if one.name == name and one.told]
        own = [one for one in own if not effect(name).threshold]
        if not own:
            continue
        size = own[int(rng.integers(len(own)))]
        hidden = hidden_of(case.plant, size, share)
        if hidden is not None:
            break
    else:
        return None
    measured = scales(case.motion.plant, exact)
    mismatch = Nuisance.drawn(
        case.motion.plant, measured, False, np.random.default_rng([seed, number, 3])
    ).beside([(hidden.name, hidden.place)])
    runs = case.runs(mismatch, [hidden])
    if not all(run.ok for run in runs):
        return None
    traces = case.traces(runs, [hidden])
    verdict = diagnose(case.plant, traces, np.random.SeedSequence(1)).verdict
    named, told = is_found(case.plant, verdict, hidden)
    return {
        "case": number,
        "robot": case.motion.plant.name,
        "hidden": hidden.to_text(),
        "share": share,
        "told": None if size.told is None else size.told.value,
        "seen": None if size.seen is None else size.seen.value,
        "nearest": size.nearest,
        "kind": verdict.kind,
        "effects": [f"{one.name}@{one.place}" for one in verdict.effects],
        "small": [f"{one.name}@{one.place}" for one in verdict.small],
        "confusable": [
            [f"{other.name}@{other.place}" for other in one.confusable_with]
            for one in verdict.effects
        ],
        "named": named,
        "found": told,
        "cpu_s": time.process_time() - begun_s,
    }


def summary(lines: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Sentences on the share found of each size, with 95 % intervals (Wilson's)."""
    for share in SHARES:
        own = [one for one in lines if one["share"] == share]
        for what in ("named", "found"):
            k, n = sum(bool(one[what]) for one in own), len(own)
            if n:
                low, high = binomtest(k, n).proportion_ci(method="wilson")
                yield (
                    f"{share:g} times the smallest size: {what} {k} of {n}, "
                    f"{100 * k / n:.0f} % ({100 * low:.0f} to {100 * high:.0f})"
                )


def main(out: Path, cases: int = 40, seed: int = 1) -> None:
    """Make and diagnose cases, and print the share found.

    Args:
      out: file with one line of JSON for each case.
      cases: number of cases.
      seed: everything random follows from it.
    """
    known = out.read_text().splitlines() if out.exists() else []
    lines = [json.loads(line) for line in known]
    done = {one["case"] for one in lines}
    out.parent.mkdir(parents=True, exist_ok=True)
    for number in range(cases):
        if number in done:
            continue
        line = cases_of(seed, number, out.parent)
        if line is not None:
            lines.append(line)
            with out.open("a") as file:
                print(json.dumps(line), file=file)
            print(json.dumps(line), flush=True)
    print(*summary(lines), sep="\n")


if __name__ == "__main__":
    run_script(main)
