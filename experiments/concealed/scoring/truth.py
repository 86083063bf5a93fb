"""What was hidden in a set of concealed cases, and what was answered."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from diagnosis.corrected.effects_json import EffectValues
from diagnosis.verdict.verdict import Verdict
from experiments.concealed.make import FORMAT, HASH, SEALED, TRUTH
from experiments.concealed.reading import BASELINE_ANSWERS
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.json_data import from_plain, parse_object


@dataclass(frozen=True)
class TrueCase:
    """What is true of one case.

    Attributes:
      name: such as "case_000".
      plant: such as "so101".
      engine: that made the recordings.
      kind: "single", "pair", "triple", "none", "outside" or "unexcited".
      effects: what is hidden.
    """

    name: str
    plant: str
    engine: str
    kind: str
    effects: tuple[EffectValues, ...] = ()


@dataclass(frozen=True)
class _SealedCase:
    """One case as the sealed file holds it; see `experiments.concealed.case`."""

    plant: str
    engine: str
    kind: str
    effects: tuple[EffectValues, ...]
    size: float | None = None
    held: tuple[str, ...] = ()

    def named(self, name: str) -> TrueCase:
        """The case under its name, without how its sizes were drawn."""
        return TrueCase(name, self.plant, self.engine, self.kind, self.effects)


@dataclass(frozen=True)
class _SealedSet:
    """The sealed file of a set: its seed, and its cases by name."""

    seed: int
    cases: Mapping[str, _SealedCase]


@dataclass(frozen=True)
class Truth:
    """The sealed file, opened.

    Attributes:
      seed: that the cases were drawn from.
      sha256: of the file, as it was printed when the cases were made.
      cases: in their order.
    """

    seed: int
    sha256: str
    cases: tuple[TrueCase, ...]


def read_truth(folder: Path) -> Truth:
    """Open the sealed file of a set of cases.

    Raises:
      RunFolderError: there is none, or it is not the one that was sealed.
    """
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
        sealed_set = from_plain(_SealedSet, plain, TRUTH, complete=False)
    except BadValueError as error:
        raise RunFolderError(f"{path}: {error}") from None
    cases = sealed_set.cases.items()
    return Truth(sealed_set.seed, found, tuple(one.named(name) for name, one in cases))


def read_answers(folder: Path, names: Sequence[str]) -> dict[str, Verdict]:
    """The verdicts in a folder by the case's name; those that are missing left out.

    Raises:
      RunFolderError: the folder is not there, or a verdict in it cannot be read.
    """
    if not folder.is_dir():
        raise RunFolderError(f"{folder} is missing: run groundwalk concealed run first")
    answers = {}
    for name in names:
        path = folder / f"{name}.json"
        if not path.is_file():
            continue
        try:
            answers[name] = Verdict.from_json(path.read_text())
        except (BadValueError, UnicodeDecodeError) as error:
            raise RunFolderError(f"{path}: {error}") from None
    return answers


def read_baselines(folder: Path, names: Sequence[str]) -> dict[str, dict[str, Verdict]]:
    """The verdicts of all baselines that answered, by their names."""
    parent = folder / BASELINE_ANSWERS
    found = sorted(path for path in parent.glob("*") if path.is_dir())
    return {path.name: read_answers(path, names) for path in found}
