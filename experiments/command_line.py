"""The command `groundwalk`, and what all its verbs share."""

import contextlib
import functools
import importlib
import io
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, NoReturn

from groundwalk.errors import GroundwalkError, UnknownNameError


class Verb(NamedTuple):
    """Where a verb's code is, and what it does in a few words.

    Attributes:
      module: its file in experiments.
      config: the dataclass of its options there, or a table of its own verbs.
      summary: what it does.
    """

    module: str
    config: str
    summary: str


VERBS = {
    "optimize-gait": Verb(
        "optimize_gait", "OptimizeGait", "tune a gait in the sim, try it in both worlds"
    ),
    "evaluate": Verb("evaluate", "Evaluate", "let gaits walk a course of 3 m"),
    "humanoids": Verb("humanoids", "Humanoids", "tune gaits for other humanoids"),
    "terrain-stress": Verb(
        "terrain_stress", "TerrainStress", "how rough may the ground be for a gait?"
    ),
    "transfer": Verb("transfer", "STUDIES", "repeat an experiment of the SGAT paper"),
    "diagnose": Verb(
        "diagnose", "Diagnose", "say what physics the sim lacks that recordings show"
    ),
    "real-robots": Verb(
        "real_robots", "RealRobots", "diagnose recordings of real robots, and judge it"
    ),
    "record": Verb(
        "record", "Record", "make a recording, with hidden physics if you like"
    ),
    "concealed": Verb(
        "concealed", "STUDIES", "recordings whose hidden physics must be found"
    ),
    "visualize": Verb("visualize", "Visualize", "see rollouts and searches in Rerun"),
    "render": Verb("render", "Render", "draw a film strip or a film of walks"),
    "export": Verb("export", "Export", "write a robot as MJCF or URDF"),
    "list": Verb(
        "list_names", "List", "show the robots, terrains or gaits that there are"
    ),
    "doctor": Verb(
        "doctor", "DoctorConfig", "say what is installed and what is missing"
    ),
}

BAD_INPUT = 2
INTERRUPTED = 130


def main() -> None:
    """Run the verb that the command line names."""
    choose(VERBS, "groundwalk", sys.argv[1:])


def choose(
    verbs: Mapping[str, Verb],
    program: str,
    arguments: Sequence[str],
    kind: str = "verb",
) -> None:
    """Run the verb that the first argument names; only its own code is imported.

    Args:
      verbs: by name; a verb may hold further ones, called studies.
      program: the command so far.
      arguments: what follows it.
      kind: what to call the verbs.
    """
    name, *options = arguments or ["--help"]
    if name in ("-h", "--help"):
        print(f"usage: {program} {kind.upper()} [options]\n")
        for known, (_, _, summary) in verbs.items():
            print(f"  {known:18}{summary}")
        print(f"\n{program} {kind.upper()} --help tells a {kind}'s options")
        return
    verb = _guarded(lambda: _verb(kind, name, verbs))
    module = importlib.import_module(f"experiments.{verb.module}")
    config = getattr(module, verb.config)
    if isinstance(config, dict):
        choose(config, f"{program} {name}", options, "study")
    else:
        run_verb(config, module.main, f"{program} {name}", options)


def run_verb(
    config_type: Any,
    verb: Callable[[Any], object],
    program: str | None = None,
    arguments: list[str] | None = None,
) -> NoReturn:
    """Parse a verb's options, do its work, and exit.

    Args:
      config_type: the verb's configuration; it checks itself.
      verb: does the work; a whole number that it returns is the exit status.
      program: the command's name in its help; by default the script's.
      arguments: by default those of the process.
    """
    config = _parse(config_type, program, arguments)
    status = _guarded(lambda: verb(config))
    sys.exit(status if isinstance(status, int) else 0)


def one_line(report: str) -> str:
    """A boxed report of the option parser as one line, without its hints on help."""
    lines = []
    for line in report.splitlines():
        text = line.strip("│╭╮╰╯─ ")
        if text.startswith("For full helptext"):
            break
        if text and not line.startswith(("╭", "╰")):
            lines.append(text)
    return " ".join(lines)


def _verb(kind: str, name: str, verbs: Mapping[str, Verb]) -> Verb:
    if name not in verbs:
        raise UnknownNameError(kind, name, verbs)
    return verbs[name]


def _parse(config_type: Any, program: str | None, arguments: list[str] | None) -> Any:
    import tyro

    # Of a class, tyro shows inherited options first; of a call, as the call has them.
    config = functools.partial(config_type)
    said = io.StringIO()
    try:
        with contextlib.redirect_stderr(said):
            return _guarded(
                lambda: tyro.cli(config, prog=program, args=arguments), said.write
            )
    except SystemExit as stop:
        if stop.code:
            _tell(one_line(said.getvalue()))
        raise


def _tell(message: str) -> None:
    print(f"groundwalk: {message}", file=sys.stderr)


def _guarded(work: Callable[[], Any], tell: Callable[[str], object] = _tell) -> Any:
    """Turn what a user can mend into one line and exit status 2."""
    try:
        return work()
    except (GroundwalkError, OSError) as error:
        tell(str(error))
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        tell("interrupted; --resume continues a run")
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
