"""Reads the sealed truth of a set of concealed test cases, and the answers to it."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from experiments.concealed.reading import BASELINE_ANSWERS, FORMAT, HASH, SEALED, TRUTH
from experiments.concealed.scoring.answers import Answer, read_answer
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.json_data import from_plain, parse_object

REAL = "real"
"""The `engine` of cases made of real recordings."""


@dataclass(frozen=True)
class TrueEffect:
    """What is missing in a case: name, place and parameters in an answer's words."""

    name: str
    place: str
    parameters: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SmallMismatch(TrueEffect):
    """A small error of the nominal model that is there, but is not asked for."""


@dataclass(frozen=True)
class TrueCase:
    """The truth of one test case, as `make_case` writes it.

    Attributes:
      plant: name of the robot model, such as "so101".
      engine: "mujoco" or "bullet", which made the recordings, or "real" for those of
        a real robot.
      kind: a key of `draw.CASE_KINDS` or `second.plan.KINDS_2`, such as "single".
      effects: the hidden effects with their parameters; of a doctored recording what
        would undo the doctoring.
      size: how easy the effects are to see: 1 easiest, 0 hard, below 0 even harder;
        None if nothing is hidden.
      held: names of the joints that never move.
      nats: information [nats per recording] on each effect, the others given; () in
        set 1, where it is measured later.
      nuisance: small mismatch.
      drive: "servos", or "torques" where the controller is unknown.
      rate_hz: ticks per second; None if not told.
      gains: number of different servo gains in the recordings; None if not told.
      reference: whether there are recordings of the healthy robot; None if not told.
      refusal: words that the refusal of a recording must hold to be right; () where
        none is.
      name: name of the case, such as "case_000"; not part of the file.
    """

    plant: str
    engine: str
    kind: str
    effects: tuple[TrueEffect, ...]
    size: float | None = None
    held: tuple[str, ...] = ()
    nats: tuple[float, ...] = ()
    nuisance: tuple[SmallMismatch, ...] = ()
    drive: str = "servos"
    rate_hz: float | None = None
    gains: int | None = None
    reference: bool | None = None
    refusal: tuple[str, ...] = ()
    name: str = ""


@dataclass(frozen=True)
class Truth:
    """The truth of a set of test cases drawn from a seed; its sealed file's hash.

    `set` is the number of the set (docs/concealed.md).
    """

    seed: int
    cases: Mapping[str, TrueCase]
    sha256: str = ""
    set: int = 1


def read_truth(folder: Path) -> Truth:
    """Open the sealed file of a set; RunFolderError if it has changed since."""
    path, stamp = folder / SEALED / TRUTH, folder / HASH
    for needed in (path, stamp):
        if not needed.is_file():
            raise RunFolderError(
                f"{needed} is missing: make a set with groundwalk concealed make"
            )
    content = path.read_bytes()
    found, sealed = hashlib.sha256(content).hexdigest(), stamp.read_text().split()
    if [found] != sealed[:1]:
        raise RunFolderError(
            f"{path} is not what was sealed: its sha256 is {found}, {stamp} says "
            f"{sealed[0] if sealed else 'nothing'}"
        )
    try:
        plain = parse_object(content, TRUTH, FORMAT)
        truth = from_plain(Truth, plain, TRUTH, complete=False)
    except BadValueError as error:
        raise RunFolderError(f"{path}: {error}") from None
    cases = {name: replace(case, name=name) for name, case in truth.cases.items()}
    return replace(truth, cases=cases, sha256=found)


def read_answers(folder: Path, names: Sequence[str]) -> dict[str, Answer]:
    """The answers in a folder, by the names of the test cases that have one."""
    if not folder.is_dir():
        raise RunFolderError(f"{folder} is missing: run groundwalk concealed run first")
    answers = {}
    for name in names:
        path = folder / f"{name}.json"
        if not path.is_file():
            continue
        try:
            answers[name] = read_answer(path.read_text())
        except (BadValueError, UnicodeDecodeError) as error:
            raise RunFolderError(f"{path}: {error}") from None
    return answers


def read_baselines(folder: Path, names: Sequence[str]) -> dict[str, dict[str, Answer]]:
    """The answers of each baseline that has some, by baseline and test case."""
    parent = folder / BASELINE_ANSWERS
    found = sorted(path for path in parent.glob("*") if path.is_dir())
    return {path.name: read_answers(path, names) for path in found}
