"""`groundwalk concealed make`: draw test cases, write recordings, seal the truth.

docs/concealed.md describes how cases are drawn.
"""

import hashlib
import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

import tyro

from experiments.command_line import run_verb
from experiments.concealed.reading import CASES, FORMAT, HASH, SEALED, TRUTH
from experiments.concealed.sets import REAL_SET, SETS, make_case
from experiments.concealed.written import case_name
from experiments.runs.options import REPEATABLE, check_at_least
from experiments.runs.processes import as_done, process_pool
from experiments.runs.progress import progress
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.files import write_text

_PARTS, _SET = "parts", "set.json"
"""In the sealed folder: subfolder with the truths of the test cases made so far, and
file with seed and number of cases of the set."""
_MOST_CASES = 1000
"""Largest number of test cases in a set, because their names have three digits."""


@dataclass(frozen=True)
class ConcealedMake:
    """Draw test cases with hidden physics, and seal their truth in a file with a hash.

    Attributes:
      folder: folder of the set of cases; an unfinished set there is continued.
      cases: number of cases.
      seed: a case depends on this seed and its own number, in set 2 also on the number
        of cases.
      set: which kind of cases: 1, exact models with one thing wrong; 2, models with
        many small errors, too, on more robots; 4, arms recorded with the identical
        model, in which nothing is missing (docs/concealed.md).
      real: folder with real recordings, of which one thing is made wrong in two of
        three cases (docs/concealed.md); `set` does not matter then.
      threads: number of processes; 0 for one per core.
    """

    if_interrupted: ClassVar[str] = REPEATABLE

    folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    cases: int = 200
    seed: int = 1
    set: int = 1
    real: Annotated[Path | None, tyro.conf.arg(metavar="DATA_DIR")] = None
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse options out of range."""
        if self.set not in SETS:
            raise BadValueError(f"set is {self.set}; {' or '.join(map(str, SETS))}")
        if not 1 <= self.cases <= _MOST_CASES:
            raise BadValueError(f"cases is {self.cases}; from 1 to {_MOST_CASES}")
        if self.real is not None and not self.real.is_dir():
            raise BadValueError(f"{self.real} is no folder of real recordings")
        check_at_least(self, seed=0, threads=0)

    @property
    def which(self) -> int:
        """Number of the set that is made."""
        return self.set if self.real is None else REAL_SET


def main(config: ConcealedMake) -> None:
    """Make the missing test cases of a set, and print the hash of its sealed truth."""
    sealed = config.folder / SEALED
    _open(config)
    if not (config.folder / HASH).exists():
        _make_all(config, sealed / _PARTS)
        _seal(config)
    print(f"{(config.folder / HASH).read_text().split()[0]}  {sealed / TRUTH}")


def _open(config: ConcealedMake) -> None:
    """Begin a set, or check that the folder holds a set with this seed and size."""
    asked = _stamp(config) | {"cases": config.cases}
    path = config.folder / SEALED / _SET
    if path.exists():
        there = json.loads(path.read_text())
        if there != asked:
            raise RunFolderError(
                f"{config.folder} holds another set ({there}); choose another folder"
            )
    elif config.folder.exists() and any(config.folder.iterdir()):
        raise RunFolderError(f"{config.folder} is not empty, and holds no set of cases")
    else:
        write_text(path, json.dumps(asked) + "\n")


def _stamp(config: ConcealedMake) -> dict[str, object]:
    """Format, seed and number of a set; the first set's files have no number."""
    which = {} if config.which == 1 else {"set": config.which}
    return {"format": FORMAT, "seed": config.seed, **which}


def _make_all(config: ConcealedMake, parts: Path) -> None:
    """Make the missing test cases of a set, several at a time."""
    cases = config.folder / CASES
    cases.mkdir(parents=True, exist_ok=True)
    missing = [i for i in range(config.cases) if not (cases / case_name(i)).exists()]
    done, where = config.cases - len(missing), (cases, parts, config.seed)
    data = () if config.real is None else (config.real,)
    with (
        progress("cases", config.cases, done) as task,
        process_pool(config.threads, len(missing)) as pool,
    ):
        calls = {
            number: pool.submit(
                make_case, config.which, *where, number, config.cases, *data
            )
            for number in missing
        }
        for _, call in as_done(calls):
            call.result()
            task.advance()


def _seal(config: ConcealedMake) -> None:
    """Write the truths of all test cases into a file, and its SHA-256 into another."""
    sealed, cases = config.folder / SEALED, {}
    for name in map(case_name, range(config.cases)):
        cases[name] = json.loads((sealed / _PARTS / f"{name}.json").read_text())
    truth = _stamp(config) | {"cases": cases}
    content = json.dumps(truth, indent=1) + "\n"
    write_text(sealed / TRUTH, content)
    digest = hashlib.sha256(content.encode()).hexdigest()
    write_text(config.folder / HASH, f"{digest}  {SEALED}/{TRUTH}\n")
    shutil.rmtree(sealed / _PARTS)


if __name__ == "__main__":
    run_verb(ConcealedMake, main)
